// GDAL, loaded when first needed. What is missing here is not found when linking.
#pragma once

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal.h>
#include <gdal_utils.h>
#include <ogr_api.h>
#include <ogr_core.h>
#include <ogr_srs_api.h>

#include "deferred_library.h"

namespace tetropolis {

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wignored-attributes"  // A type does not say "use the result".

inline constinit DeferredLibrary gdal_library(TETROPOLIS_GDAL_FILE);

TETROPOLIS_DEFER(gdal_library, CPLCopyFile);
TETROPOLIS_DEFER(gdal_library, CPLErrorReset);
TETROPOLIS_DEFER(gdal_library, CPLGetErrorHandlerUserData);
TETROPOLIS_DEFER(gdal_library, CPLGetThreadLocalConfigOption);
TETROPOLIS_DEFER(gdal_library, CPLIsUTF8);
TETROPOLIS_DEFER(gdal_library, CPLPopErrorHandler);
TETROPOLIS_DEFER(gdal_library, CPLPushErrorHandlerEx);
TETROPOLIS_DEFER(gdal_library, CPLRecode);
TETROPOLIS_DEFER(gdal_library, CPLSetConfigOption);
TETROPOLIS_DEFER(gdal_library, CPLSetThreadLocalConfigOption);

TETROPOLIS_DEFER(gdal_library, CSLAddString);
TETROPOLIS_DEFER(gdal_library, CSLCount);
TETROPOLIS_DEFER(gdal_library, CSLDestroy);
TETROPOLIS_DEFER(gdal_library, CSLSetNameValue);

TETROPOLIS_DEFER(gdal_library, GDALAllRegister);
TETROPOLIS_DEFER(gdal_library, GDALClose);
TETROPOLIS_DEFER(gdal_library, GDALCreate);
TETROPOLIS_DEFER(gdal_library, GDALDatasetCommitTransaction);
TETROPOLIS_DEFER(gdal_library, GDALDatasetCreateLayer);
TETROPOLIS_DEFER(gdal_library, GDALDatasetGetLayer);
TETROPOLIS_DEFER(gdal_library, GDALDatasetGetLayerCount);
TETROPOLIS_DEFER(gdal_library, GDALDatasetStartTransaction);
TETROPOLIS_DEFER(gdal_library, GDALGetDatasetDriver);
TETROPOLIS_DEFER(gdal_library, GDALGetDriverByName);
TETROPOLIS_DEFER(gdal_library, GDALGetDriverShortName);
TETROPOLIS_DEFER(gdal_library, GDALGetGeoTransform);
TETROPOLIS_DEFER(gdal_library, GDALGetMaskBand);
TETROPOLIS_DEFER(gdal_library, GDALGetMaskFlags);
TETROPOLIS_DEFER(gdal_library, GDALGetMetadataItem);
TETROPOLIS_DEFER(gdal_library, GDALGetRasterBand);
TETROPOLIS_DEFER(gdal_library, GDALGetRasterCount);
TETROPOLIS_DEFER(gdal_library, GDALGetRasterDataType);
TETROPOLIS_DEFER(gdal_library, GDALGetRasterNoDataValue);
TETROPOLIS_DEFER(gdal_library, GDALGetRasterOffset);
TETROPOLIS_DEFER(gdal_library, GDALGetRasterScale);
TETROPOLIS_DEFER(gdal_library, GDALGetRasterUnitType);
TETROPOLIS_DEFER(gdal_library, GDALGetRasterXSize);
TETROPOLIS_DEFER(gdal_library, GDALGetRasterYSize);
TETROPOLIS_DEFER(gdal_library, GDALGetSpatialRef);
TETROPOLIS_DEFER(gdal_library, GDALOpenEx);
TETROPOLIS_DEFER(gdal_library, GDALRasterIO);
TETROPOLIS_DEFER(gdal_library, GDALSetGeoTransform);
TETROPOLIS_DEFER(gdal_library, GDALSetMetadataItem);
TETROPOLIS_DEFER(gdal_library, GDALSetRasterNoDataValue);
TETROPOLIS_DEFER(gdal_library, GDALSetSpatialRef);
TETROPOLIS_DEFER(gdal_library, GDALWarp);
TETROPOLIS_DEFER(gdal_library, GDALWarpAppOptionsFree);
TETROPOLIS_DEFER(gdal_library, GDALWarpAppOptionsNew);
TETROPOLIS_DEFER(gdal_library, GDALWriteBlock);

TETROPOLIS_DEFER(gdal_library, OCTDestroyCoordinateTransformation);
TETROPOLIS_DEFER(gdal_library, OCTNewCoordinateTransformation);
TETROPOLIS_DEFER(gdal_library, OCTTransformEx);

TETROPOLIS_DEFER(gdal_library, OGRGeometryTypeToName);
TETROPOLIS_DEFER(gdal_library, OGR_FD_GetFieldCount);
TETROPOLIS_DEFER(gdal_library, OGR_FD_GetFieldDefn);
TETROPOLIS_DEFER(gdal_library, OGR_FD_GetFieldIndex);
TETROPOLIS_DEFER(gdal_library, OGR_FD_GetGeomFieldCount);
TETROPOLIS_DEFER(gdal_library, OGR_FD_GetGeomFieldDefn);
TETROPOLIS_DEFER(gdal_library, OGR_F_Create);
TETROPOLIS_DEFER(gdal_library, OGR_F_Destroy);
TETROPOLIS_DEFER(gdal_library, OGR_F_GetFID);
TETROPOLIS_DEFER(gdal_library, OGR_F_GetFieldAsDateTimeEx);
TETROPOLIS_DEFER(gdal_library, OGR_F_GetFieldAsDouble);
TETROPOLIS_DEFER(gdal_library, OGR_F_GetFieldAsInteger64);
TETROPOLIS_DEFER(gdal_library, OGR_F_GetFieldAsString);
TETROPOLIS_DEFER(gdal_library, OGR_F_GetGeomFieldRef);
TETROPOLIS_DEFER(gdal_library, OGR_F_IsFieldSetAndNotNull);
TETROPOLIS_DEFER(gdal_library, OGR_F_SetFID);
TETROPOLIS_DEFER(gdal_library, OGR_F_SetFieldDouble);
TETROPOLIS_DEFER(gdal_library, OGR_F_SetFieldInteger64);
TETROPOLIS_DEFER(gdal_library, OGR_F_SetFieldString);
TETROPOLIS_DEFER(gdal_library, OGR_F_SetGeometryDirectly);
TETROPOLIS_DEFER(gdal_library, OGR_Fld_Create);
TETROPOLIS_DEFER(gdal_library, OGR_Fld_Destroy);
TETROPOLIS_DEFER(gdal_library, OGR_Fld_GetNameRef);
TETROPOLIS_DEFER(gdal_library, OGR_Fld_GetSubType);
TETROPOLIS_DEFER(gdal_library, OGR_Fld_GetType);
TETROPOLIS_DEFER(gdal_library, OGR_Fld_SetPrecision);
TETROPOLIS_DEFER(gdal_library, OGR_Fld_SetSubType);
TETROPOLIS_DEFER(gdal_library, OGR_Fld_SetWidth);
TETROPOLIS_DEFER(gdal_library, OGR_GFld_GetSpatialRef);
TETROPOLIS_DEFER(gdal_library, OGR_GFld_GetType);
TETROPOLIS_DEFER(gdal_library, OGR_GT_Flatten);
TETROPOLIS_DEFER(gdal_library, OGR_G_AddGeometryDirectly);
TETROPOLIS_DEFER(gdal_library, OGR_G_AddPoint_2D);
TETROPOLIS_DEFER(gdal_library, OGR_G_Area);
TETROPOLIS_DEFER(gdal_library, OGR_G_CloseRings);
TETROPOLIS_DEFER(gdal_library, OGR_G_CreateFromWkb);
TETROPOLIS_DEFER(gdal_library, OGR_G_CreateGeometry);
TETROPOLIS_DEFER(gdal_library, OGR_G_DestroyGeometry);
TETROPOLIS_DEFER(gdal_library, OGR_G_Difference);
TETROPOLIS_DEFER(gdal_library, OGR_G_GetEnvelope);
TETROPOLIS_DEFER(gdal_library, OGR_G_GetGeometryCount);
TETROPOLIS_DEFER(gdal_library, OGR_G_GetGeometryRef);
TETROPOLIS_DEFER(gdal_library, OGR_G_GetGeometryType);
TETROPOLIS_DEFER(gdal_library, OGR_G_GetLinearGeometry);
TETROPOLIS_DEFER(gdal_library, OGR_G_GetPointCount);
TETROPOLIS_DEFER(gdal_library, OGR_G_GetX);
TETROPOLIS_DEFER(gdal_library, OGR_G_GetY);
TETROPOLIS_DEFER(gdal_library, OGR_G_GetZ);
TETROPOLIS_DEFER(gdal_library, OGR_G_HasCurveGeometry);
TETROPOLIS_DEFER(gdal_library, OGR_G_Intersection);
TETROPOLIS_DEFER(gdal_library, OGR_G_Is3D);
TETROPOLIS_DEFER(gdal_library, OGR_G_IsEmpty);
TETROPOLIS_DEFER(gdal_library, OGR_G_IsValid);
TETROPOLIS_DEFER(gdal_library, OGR_G_MakeValid);
TETROPOLIS_DEFER(gdal_library, OGR_G_Union);
TETROPOLIS_DEFER(gdal_library, OGR_GetFieldTypeName);
TETROPOLIS_DEFER(gdal_library, OGR_L_CommitTransaction);
TETROPOLIS_DEFER(gdal_library, OGR_L_CreateFeature);
TETROPOLIS_DEFER(gdal_library, OGR_L_CreateField);
TETROPOLIS_DEFER(gdal_library, OGR_L_GetFIDColumn);
TETROPOLIS_DEFER(gdal_library, OGR_L_GetFeatureCount);
TETROPOLIS_DEFER(gdal_library, OGR_L_GetGeomType);
TETROPOLIS_DEFER(gdal_library, OGR_L_GetLayerDefn);
TETROPOLIS_DEFER(gdal_library, OGR_L_GetName);
TETROPOLIS_DEFER(gdal_library, OGR_L_GetNextFeature);
TETROPOLIS_DEFER(gdal_library, OGR_L_GetSpatialRef);
TETROPOLIS_DEFER(gdal_library, OGR_L_ResetReading);
TETROPOLIS_DEFER(gdal_library, OGR_L_SetAttributeFilter);
TETROPOLIS_DEFER(gdal_library, OGR_L_StartTransaction);

TETROPOLIS_DEFER(gdal_library, OSRClone);
TETROPOLIS_DEFER(gdal_library, OSRCloneGeogCS);
TETROPOLIS_DEFER(gdal_library, OSRDemoteTo2D);
TETROPOLIS_DEFER(gdal_library, OSRDestroySpatialReference);
TETROPOLIS_DEFER(gdal_library, OSRExportToPROJJSON);
TETROPOLIS_DEFER(gdal_library, OSRExportToWkt);
TETROPOLIS_DEFER(gdal_library, OSRExportToWktEx);
TETROPOLIS_DEFER(gdal_library, OSRFindMatches);
TETROPOLIS_DEFER(gdal_library, OSRFreeSRSArray);
TETROPOLIS_DEFER(gdal_library, OSRGetAngularUnits);
TETROPOLIS_DEFER(gdal_library, OSRGetAreaOfUse);
TETROPOLIS_DEFER(gdal_library, OSRGetAttrValue);
TETROPOLIS_DEFER(gdal_library, OSRGetAuthorityCode);
TETROPOLIS_DEFER(gdal_library, OSRGetAuthorityName);
TETROPOLIS_DEFER(gdal_library, OSRGetAxesCount);
TETROPOLIS_DEFER(gdal_library, OSRGetAxis);
TETROPOLIS_DEFER(gdal_library, OSRGetDataAxisToSRSAxisMapping);
TETROPOLIS_DEFER(gdal_library, OSRGetInvFlattening);
TETROPOLIS_DEFER(gdal_library, OSRGetLinearUnits);
TETROPOLIS_DEFER(gdal_library, OSRGetName);
TETROPOLIS_DEFER(gdal_library, OSRGetPROJSearchPaths);
TETROPOLIS_DEFER(gdal_library, OSRGetSemiMajor);
TETROPOLIS_DEFER(gdal_library, OSRGetTargetLinearUnits);
TETROPOLIS_DEFER(gdal_library, OSRImportFromEPSG);
TETROPOLIS_DEFER(gdal_library, OSRIsGeographic);
TETROPOLIS_DEFER(gdal_library, OSRIsLocal);
TETROPOLIS_DEFER(gdal_library, OSRIsProjected);
TETROPOLIS_DEFER(gdal_library, OSRIsSameEx);
TETROPOLIS_DEFER(gdal_library, OSRMorphToESRI);
TETROPOLIS_DEFER(gdal_library, OSRNewSpatialReference);
TETROPOLIS_DEFER(gdal_library, OSRSetAxes);
TETROPOLIS_DEFER(gdal_library, OSRSetAxisMappingStrategy);
TETROPOLIS_DEFER(gdal_library, OSRSetFromUserInput);
TETROPOLIS_DEFER(gdal_library, OSRSetLinearUnitsAndUpdateParameters);
TETROPOLIS_DEFER(gdal_library, OSRSetPROJSearchPaths);
TETROPOLIS_DEFER(gdal_library, OSRSetProjCS);
TETROPOLIS_DEFER(gdal_library, OSRStripVertical);

TETROPOLIS_DEFER(gdal_library, VSIFCloseL);
TETROPOLIS_DEFER(gdal_library, VSIFOpenL);
TETROPOLIS_DEFER(gdal_library, VSIFReadL);
TETROPOLIS_DEFER(gdal_library, VSIFWriteL);
TETROPOLIS_DEFER(gdal_library, VSIFileFromMemBuffer);
TETROPOLIS_DEFER(gdal_library, VSIFree);
TETROPOLIS_DEFER(gdal_library, VSIGetMemFileBuffer);
TETROPOLIS_DEFER(gdal_library, VSIReadDir);
TETROPOLIS_DEFER(gdal_library, VSIReadDirRecursive);
TETROPOLIS_DEFER(gdal_library, VSIRmdirRecursive);

}  // namespace tetropolis
