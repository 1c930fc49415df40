// HDF5, loaded when first needed. What is missing here is not found when linking.
#pragma once

#include <hdf5.h>
#if H5_VERSION_GE(1, 13, 0)
#include <H5FDdevelop.h>
#endif

#include "deferred_library.h"

namespace tetropolis {

inline constinit DeferredLibrary hdf5_library(TETROPOLIS_HDF5_FILE);

TETROPOLIS_DEFER(hdf5_library, H5Aclose);
TETROPOLIS_DEFER(hdf5_library, H5Acreate2);
TETROPOLIS_DEFER(hdf5_library, H5Awrite);
TETROPOLIS_DEFER(hdf5_library, H5Dclose);
TETROPOLIS_DEFER(hdf5_library, H5Dcreate2);
TETROPOLIS_DEFER(hdf5_library, H5Dget_offset);
TETROPOLIS_DEFER(hdf5_library, H5Dget_space);
TETROPOLIS_DEFER(hdf5_library, H5Dget_storage_size);
TETROPOLIS_DEFER(hdf5_library, H5Dget_type);
TETROPOLIS_DEFER(hdf5_library, H5Dopen2);
TETROPOLIS_DEFER(hdf5_library, H5Dread);
TETROPOLIS_DEFER(hdf5_library, H5Dwrite);
TETROPOLIS_DEFER(hdf5_library, H5Dwrite_chunk);
TETROPOLIS_DEFER(hdf5_library, H5Eget_auto2);
TETROPOLIS_DEFER(hdf5_library, H5Eset_auto2);
TETROPOLIS_DEFER(hdf5_library, H5FDregister);
TETROPOLIS_DEFER(hdf5_library, H5FDunregister);
TETROPOLIS_DEFER(hdf5_library, H5Fclose);
TETROPOLIS_DEFER(hdf5_library, H5Fcreate);
TETROPOLIS_DEFER(hdf5_library, H5Fopen);
TETROPOLIS_DEFER(hdf5_library, H5Gclose);
TETROPOLIS_DEFER(hdf5_library, H5Gcreate2);
TETROPOLIS_DEFER(hdf5_library, H5Gopen2);
TETROPOLIS_DEFER(hdf5_library, H5Pclose);
TETROPOLIS_DEFER(hdf5_library, H5Pcreate);
TETROPOLIS_DEFER(hdf5_library, H5Pget_driver_info);
TETROPOLIS_DEFER(hdf5_library, H5Pset_alloc_time);
TETROPOLIS_DEFER(hdf5_library, H5Pset_chunk);
TETROPOLIS_DEFER(hdf5_library, H5Pset_create_intermediate_group);
TETROPOLIS_DEFER(hdf5_library, H5Pset_deflate);
TETROPOLIS_DEFER(hdf5_library, H5Pset_driver);
TETROPOLIS_DEFER(hdf5_library, H5Pset_fill_time);
TETROPOLIS_DEFER(hdf5_library, H5Pset_layout);
TETROPOLIS_DEFER(hdf5_library, H5Pset_link_creation_order);
TETROPOLIS_DEFER(hdf5_library, H5Pset_obj_track_times);
TETROPOLIS_DEFER(hdf5_library, H5Pset_shuffle);
TETROPOLIS_DEFER(hdf5_library, H5Pset_small_data_block_size);
TETROPOLIS_DEFER(hdf5_library, H5Sclose);
TETROPOLIS_DEFER(hdf5_library, H5Screate);
TETROPOLIS_DEFER(hdf5_library, H5Screate_simple);
TETROPOLIS_DEFER(hdf5_library, H5Sget_simple_extent_dims);
TETROPOLIS_DEFER(hdf5_library, H5Sget_simple_extent_ndims);
TETROPOLIS_DEFER(hdf5_library, H5Tclose);
TETROPOLIS_DEFER(hdf5_library, H5Tcopy);
TETROPOLIS_DEFER(hdf5_library, H5Tequal);
TETROPOLIS_DEFER(hdf5_library, H5Tset_size);
TETROPOLIS_DEFER(hdf5_library, H5Tset_strpad);
TETROPOLIS_DEFER(hdf5_library, H5check_version);
TETROPOLIS_DEFER(hdf5_library, H5open);

TETROPOLIS_DEFER_VALUE(hdf5_library, H5P_CLS_DATASET_CREATE_ID_g);
TETROPOLIS_DEFER_VALUE(hdf5_library, H5P_CLS_FILE_ACCESS_ID_g);
TETROPOLIS_DEFER_VALUE(hdf5_library, H5P_CLS_GROUP_CREATE_ID_g);
TETROPOLIS_DEFER_VALUE(hdf5_library, H5P_CLS_LINK_CREATE_ID_g);
TETROPOLIS_DEFER_VALUE(hdf5_library, H5T_C_S1_g);
TETROPOLIS_DEFER_VALUE(hdf5_library, H5T_IEEE_F64LE_g);
TETROPOLIS_DEFER_VALUE(hdf5_library, H5T_NATIVE_FLOAT_g);
TETROPOLIS_DEFER_VALUE(hdf5_library, H5T_NATIVE_INT32_g);
TETROPOLIS_DEFER_VALUE(hdf5_library, H5T_NATIVE_INT64_g);
TETROPOLIS_DEFER_VALUE(hdf5_library, H5T_NATIVE_SCHAR_g);
TETROPOLIS_DEFER_VALUE(hdf5_library, H5T_STD_I32LE_g);
TETROPOLIS_DEFER_VALUE(hdf5_library, H5T_STD_I64LE_g);
TETROPOLIS_DEFER_VALUE(hdf5_library, H5T_STD_U8LE_g);

}  // namespace tetropolis
