"""The flat faces of a body whose mesh is known, and how well the planes found in its points agree with them.

A true face is grown from its largest triangle over triangles whose corners lie within FLAT of its plane; the grouping by
normals of `zeroset compare` cuts the faces of meshes with rounded coordinates in pieces. A face of which more than a
third of the border turns by less than SHALLOW into the next one is a facet of something round, or runs into it, and a
narrow one is often a strip of something round: these may be found, and need not be. A true face is found if a plane holds more than half of its points.

A plane is right if more than half of its points lie on one face. The best that can be had is the plane of least squares
through the points that were sampled on the face: its error is given beside that of the planes found.
"""

import numpy as np

FLAT = 5e-4  # over the diagonal
FIRST_REFIT = 8  # triangles; again whenever they have doubled
SAME = np.cos(np.radians(15.0))
SHALLOW = np.cos(np.radians(20.0))
MOST_SHALLOW = 1 / 3
LEAST_CELLS, CELLS_ALONG = 20, 107  # the area of a face that counts, in cells of the longest side over 107
LEAST_WIDTH = 2  # twice the area over the length of the border, in cells


class Faces:
    """Faces of a mesh with a diagonal of 1."""

    def __init__(self, vertices, triangles):
        a, b, c = (vertices[triangles[:, k]] for k in range(3))
        cross = np.cross(b - a, c - a)
        double = np.linalg.norm(cross, axis=1)
        self.areas = 0.5 * double
        normals = cross / np.maximum(double, 1e-300)[:, None]
        ends = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        order = np.lexsort((ends[:, 1], ends[:, 0]))
        pairs = np.flatnonzero((ends[order][1:] == ends[order][:-1]).all(axis=1))
        first, second = order[pairs] // 3, order[pairs + 1] // 3
        beside = [[] for _ in triangles]
        for i, j in zip(first, second):
            beside[i].append(j)
            beside[j].append(i)
        self.of = np.full(len(triangles), -1)
        self.normals, self.centres, sizes = [], [], []
        for seed in np.argsort(-self.areas, kind="stable"):
            if self.of[seed] >= 0 or self.areas[seed] == 0:
                continue
            number, face, refit = len(sizes), [seed], FIRST_REFIT
            self.of[seed] = number
            normal, offset = normals[seed], a[seed] @ normals[seed]
            for place, i in enumerate(face):
                if place == refit:
                    refit *= 2
                    corners = vertices[triangles[face].ravel()]
                    normal = np.linalg.eigh(np.cov(corners.T))[1][:, 0]
                    offset = normal @ corners.mean(axis=0)
                for j in beside[i]:
                    flat = np.abs(vertices[triangles[j]] @ normal - offset).max() <= FLAT
                    # A sliver has no direction to speak of.
                    along = abs(normals[j] @ normal) >= SAME or self.areas[j] < FLAT**2
                    if self.of[j] < 0 and flat and along:
                        self.of[j] = number
                        face.append(j)
            mean = cross[face].sum(axis=0)
            weights = self.areas[face] / self.areas[face].sum()
            self.normals.append(mean / np.linalg.norm(mean))
            self.centres.append(weights @ ((a + b + c) / 3)[face])
            sizes.append(self.areas[face].sum())
        self.normals, self.centres, self.sizes = map(np.array, (self.normals, self.centres, sizes))
        cell = (vertices.max(axis=0) - vertices.min(axis=0)).max() / CELLS_ALONG
        lengths = np.linalg.norm(np.diff(vertices[ends[order[pairs]]], axis=1)[:, 0], axis=1)
        self.is_optional = self._optional(first, second, lengths, cell)
        self.is_large = self.sizes >= LEAST_CELLS * cell**2

    def _optional(self, first, second, lengths, cell):
        """Which faces run on smoothly over too much of their border, or are narrow."""
        one, other = self.of[first], self.of[second]
        border = one != other
        turn = np.einsum("ij,ij->i", self.normals[one], self.normals[other])
        whole, shallow = np.zeros(len(self.sizes)), np.zeros(len(self.sizes))
        for side in (one, other):
            np.add.at(whole, side[border], lengths[border])
            np.add.at(shallow, side[border], (lengths * (turn > SHALLOW))[border])
        return (shallow > MOST_SHALLOW * whole) | (2 * self.sizes < LEAST_WIDTH * cell * whole)

    def judged(self, points, triangle, plane, normals, offsets):
        """Compares the planes of points that were sampled on known triangles; plane -1 is none."""
        face, count = self.of[triangle], len(self.sizes)
        held = np.bincount(face, minlength=count)
        common = np.zeros((len(normals), count), int)
        np.add.at(common, (plane[plane >= 0], face[plane >= 0]), 1)
        wanted = np.flatnonzero(self.is_large & ~self.is_optional)
        right = common.max(axis=1, initial=0) * 2 > common.sum(axis=1)
        best = common.argmax(axis=0) if len(normals) else np.zeros(count, int)
        angles, shifts, least_angles = [], [], []
        for f in wanted:
            if not len(normals) or 2 * common[best[f], f] <= held[f]:
                continue
            n, d = normals[best[f]], offsets[best[f]]
            angles.append(angle(n, self.normals[f]))
            shifts.append(abs(n @ self.centres[f] - d))
            own = points[face == f]
            least_angles.append(angle(np.linalg.eigh(np.cov(own.T))[1][:, 0], self.normals[f]))
        angles, least_angles = np.array(angles), np.array(least_angles)
        return {
            "faces": len(wanted),
            "recall": len(angles) / len(wanted) if len(wanted) else None,
            "precision": right.mean() if len(normals) else None,
            "angle": angles.mean() if len(angles) else None,
            "least_angle": least_angles.mean() if len(angles) else None,
            "shift": np.mean(shifts) if shifts else None,
        }


def angle(a, b):
    """Degrees between two lines."""
    return np.degrees(np.arccos(min(1.0, abs(a @ b))))
