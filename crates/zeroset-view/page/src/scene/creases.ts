/** Normals of a surface that is smooth where it bends little, and sharp elsewhere. */

/** A surface is smooth at a corner whose normal is within 25 degrees of that of the triangle: the cosine. The same as in `zeroset render`. */
const SMOOTH = 0.906;
const LARGEST = 32767;

export interface CreasedSurface {
  /** For each vertex that is drawn the one of the surface; the first ones are those of the surface themselves. */
  sources: Uint32Array;
  indices: Uint32Array;
  /** Four codes for each vertex that is drawn: a normal, and padding. */
  normals: Int16Array;
}

/** Gives a corner a vertex of its own wherever the triangle leaves the vertex's plane by too much. */
export function splitCreases(positions: Float32Array, indices: Uint32Array): CreasedSurface {
  const vertices = positions.length / 3;
  const faces = faceNormals(positions, indices);
  const sums = vertexNormals(vertices, indices, faces);
  const isSharp = (corner: number): boolean => {
    const face = 3 * Math.floor(corner / 3);
    const vertex = 3 * indices[corner];
    const dot =
      faces[face] * sums[vertex] + faces[face + 1] * sums[vertex + 1] + faces[face + 2] * sums[vertex + 2];
    const lengths =
      Math.hypot(faces[face], faces[face + 1], faces[face + 2]) *
      Math.hypot(sums[vertex], sums[vertex + 1], sums[vertex + 2]);
    return dot <= SMOOTH * lengths;
  };
  let sharp = 0;
  for (let corner = 0; corner < indices.length; corner++) {
    sharp += Number(isSharp(corner));
  }
  const sources = new Uint32Array(vertices + sharp);
  const normals = new Int16Array(4 * (vertices + sharp));
  for (let vertex = 0; vertex < vertices; vertex++) {
    sources[vertex] = vertex;
    encode(sums, 3 * vertex, normals, 4 * vertex);
  }
  const split = indices.slice();
  let next = vertices;
  for (let corner = 0; corner < indices.length; corner++) {
    if (isSharp(corner)) {
      sources[next] = indices[corner];
      encode(faces, 3 * Math.floor(corner / 3), normals, 4 * next);
      split[corner] = next;
      next += 1;
    }
  }
  return { sources, indices: split, normals };
}

/** For each triangle a vector along its normal, as long as twice its area. */
function faceNormals(positions: Float32Array, indices: Uint32Array): Float32Array {
  const normals = new Float32Array(indices.length);
  for (let at = 0; at < indices.length; at += 3) {
    const [a, b, c] = [3 * indices[at], 3 * indices[at + 1], 3 * indices[at + 2]];
    const ux = positions[b] - positions[a];
    const uy = positions[b + 1] - positions[a + 1];
    const uz = positions[b + 2] - positions[a + 2];
    const vx = positions[c] - positions[a];
    const vy = positions[c + 1] - positions[a + 1];
    const vz = positions[c + 2] - positions[a + 2];
    normals[at] = uy * vz - uz * vy;
    normals[at + 1] = uz * vx - ux * vz;
    normals[at + 2] = ux * vy - uy * vx;
  }
  return normals;
}

function vertexNormals(vertices: number, indices: Uint32Array, faces: Float32Array): Float32Array {
  const sums = new Float32Array(3 * vertices);
  for (let corner = 0; corner < indices.length; corner++) {
    const face = 3 * Math.floor(corner / 3);
    const vertex = 3 * indices[corner];
    sums[vertex] += faces[face];
    sums[vertex + 1] += faces[face + 1];
    sums[vertex + 2] += faces[face + 2];
  }
  return sums;
}

function encode(from: Float32Array, at: number, into: Int16Array, to: number): void {
  const scale = LARGEST / (Math.hypot(from[at], from[at + 1], from[at + 2]) || 1);
  into[to] = Math.round(from[at] * scale);
  into[to + 1] = Math.round(from[at + 1] * scale);
  into[to + 2] = Math.round(from[at + 2] * scale);
}
