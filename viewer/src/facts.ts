// What the page knows of the run besides the mesh: the block "facts" (src/io/page/page.cpp).

export interface Building {
  id: string;
  sources: string[];
  ground: number;
  roof: number;
  /** Of its highest roof. */
  top: number;
  groundPoints: number;
  roofPoints: number;
  flags: string[];
  area: number;
  /** Of its roof, where it is not one level block. */
  parts?: number;
  lod?: string;
  /** Metres; none without points. */
  rmse?: number;
}

/** An input feature: part of a building, or dropped for a reason. */
export interface Footprint {
  source: string;
  building: number;
  reason?: string;
}

export interface StepTime {
  id: string;
  name: string;
  seconds: number;
  cpu_seconds: number;
  peak_rss_bytes?: number;
}

export interface WorstCell {
  position: [number, number, number];
  min_dihedral_deg: number;
  max_dihedral_deg: number;
  cause: string;
}

export interface Warning {
  code: string;
  count: number;
  message: string;
}

/** How many cells buildings, or gaps, have. */
export interface CellScore {
  count: number;
  median: number;
  share_of_ten: number;
}

/** The part of report.json that is shown; docs/report.md describes it. */
export interface Report {
  version: string;
  command: string;
  config: Record<string, unknown>;
  steps: StepTime[];
  peak_rss_bytes: number;
  threads: number;
  input?: {points_read: number; points_kept: number; footprints_read: number};
  city?: {raw_buildings: number; buildings: number; merged_groups: number; min_clearance: number | null;
          domain?: {building_height: number; tallest_building: string; blockage: number; length: number; width: number}};
  ground_mesh?: {vertices: number; triangles: number; min_angle_deg: number;
                 cells_per_building?: CellScore; cells_per_gap?: CellScore};
  volume_mesh?: {
    vertices: number; cells: number; volume: number; inverted: number; top: number;
    dihedral_deg: {min: number; p0_01: number; p1: number; median: number; max: number;
                   counts?: number[]};
    aspect_ratio: {median: number; p99: number; max: number};
    worst_cells: WorstCell[];
    prisms?: {cells: number; non_orthogonality_deg: {max: number; mean: number}};
  };
  surface_mesh?: {triangles: number; closed: boolean; manifold: boolean;
                  faces_by_patch: Record<string, number>};
  files?: string[];
  warnings: Warning[];
}

export interface Facts {
  version: string;
  /** Metres in one of the whole numbers that coordinates are. */
  step: number;
  /** Of the local frame, in the CRS. */
  origin: [number, number];
  crs: string;
  /** xmin, ymin, xmax, ymax; local frame, metres. */
  domain: [number, number, number, number];
  /** x and y of the domain's corners in turn; local frame, metres. */
  outline: number[];
  /** Whether the page has the surface, and the cells. */
  mesh: boolean;
  volume: boolean;
  /** Layers of prisms on open ground; whether there are prisms only. */
  layers: number;
  whole: boolean;
  /** That there are, in the page or not. */
  cells: number;
  buildings: Building[];
  footprints: Footprint[];
  /** Features dropped, by reason. */
  dropped: Record<string, number>;
  repeat: string;
  report?: Report;
}
