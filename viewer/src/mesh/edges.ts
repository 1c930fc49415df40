// Edges of the ground mesh where something ends: the domain, or a region.

import type {ColumnMesh} from './columns.js';

/**
 * Half-edges c (of triangle c / 3, from its corner c % 3 to the next) on the rim of the mesh, and
 * pairs of them that run along an edge between two regions.
 */
export interface BorderEdges {
  rim: Int32Array;
  /** Two by two. */
  between: Int32Array;
}

/** The corner that half-edge c ends at. */
export const nextCorner = (c: number): number => (c % 3 === 2 ? c - 2 : c + 1);

export function borderEdges(mesh: ColumnMesh): BorderEdges {
  const {corners, region} = mesh;
  const vertices = mesh.x.length;
  // Half-edges by their lower vertex, of which few have the same.
  const first = new Int32Array(vertices + 1);
  for (let c = 0; c < corners.length; ++c)
    ++first[Math.min(corners[c], corners[nextCorner(c)]) + 1];
  for (let v = 0; v < vertices; ++v) first[v + 1] += first[v];
  const byVertex = new Int32Array(corners.length);
  const fill = first.slice();
  for (let c = 0; c < corners.length; ++c)
    byVertex[fill[Math.min(corners[c], corners[nextCorner(c)])]++] = c;

  const rim: number[] = [], between: number[] = [];
  const high = (c: number): number => Math.max(corners[c], corners[nextCorner(c)]);
  for (let v = 0; v < vertices; ++v) {
    for (let i = first[v]; i < first[v + 1]; ++i) {
      const c = byVertex[i];
      let partner = -1;
      for (let j = first[v]; j < first[v + 1] && partner < 0; ++j)
        if (j !== i && high(byVertex[j]) === high(c)) partner = byVertex[j];
      if (partner < 0) rim.push(c);
      else if (c < partner && region[(c / 3) | 0] !== region[(partner / 3) | 0]) between.push(c, partner);
    }
  }
  return {rim: Int32Array.from(rim), between: Int32Array.from(between)};
}
