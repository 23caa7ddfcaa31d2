"""SciPy's least_squares on single problems of a light field map, with analytic Jacobians, in double precision."""
import time

import numpy as np
import scipy.optimize
import scipy.sparse

from light_field import laplacian


class Problem:
    """A vertex and a channel: residuals whose halved sum of squares is the problem's error, and their Jacobian. Unknowns [K s + K w]
    are those of its s surface texels, then of its w view texels, a term behind the other."""

    def __init__(self, problem, vertex, channel):
        """problem: LightField."""
        a, maps, self.objective = problem.arrays, problem.about["maps"], problem.objective
        self.vertex, self.channel, self.terms = vertex, channel, maps["terms"]
        self.texels = np.arange(*a["vertex_texels"][vertex : vertex + 2])
        group_of, corner_of = np.nonzero(a["triangle_vertices"][a["training_group_triangle"]] == vertex)
        first, image = a["training_group_first"], a["training_group_image"][group_of]
        counts = np.diff(first)[group_of]
        sample = np.concatenate([np.arange(*first[g : g + 2]) for g in group_of])
        map = a["triangle_maps"][a["training_group_triangle"][group_of], corner_of]
        texel = np.repeat(map, counts) + a["training_texel"][sample]
        root = np.sqrt(a["inverse_density"][vertex] * a["training_weight"][vertex, image].astype(float))
        side = maps["view_side"]
        self.texel, self.image = texel - self.texels[0], np.repeat(np.arange(len(image)), counts)
        self.view_texel = a["training_view_texel"][vertex, image][:, None] + [0, 1, side, side + 1]  # [images, 4]
        self.view_weights = root[:, None] * a["training_view_weights"][vertex, image]
        self.target = np.repeat(root, counts) * a["barycentric"][texel] * a["training_radiance"][sample, channel]
        s, w, K, n = len(self.texels), side * side, self.terms, len(texel)
        self.sizes = s, w
        bent = laplacian(a["surface_neighbours"][self.texels] - self.texels[0]) * self.objective["lambda_surface"] ** 0.5
        view_bent = laplacian(a["view_neighbours"]) * float(a["lambda_view"][vertex, channel]) ** 0.5
        blocks = [scipy.sparse.csr_matrix(block) for block in (bent, view_bent)]
        self.smoothness = scipy.sparse.block_diag([blocks[0]] * K + [blocks[1]] * K, "csr")
        # Of a sample's row: for each term its surface texel, then the four view texels that its image looks up.
        columns = [k * s + self.texel[:, None] for k in range(K)]
        columns += [K * s + k * w + self.view_texel[self.image] for k in range(K)]
        self.columns, self.first = np.hstack(columns).reshape(-1), np.arange(0, 5 * K * n + 1, 5 * K)
        self.bounded = np.concatenate([np.arange(s), K * s + np.arange(w)])  # unknowns of the first term
        self.start = self.pack(*[x.double().numpy() for x in problem.start])

    def pack(self, surface, view):
        """Unknowns of exported maps."""
        maps = surface[self.texels, :, self.channel], view[self.vertex, :, :, self.channel]
        return np.concatenate([map.T.reshape(-1) for map in maps])

    def unpack(self, x, surface, view):
        """Unknowns into exported maps."""
        s, w = self.sizes
        surface[self.texels, :, self.channel] = x[: self.terms * s].reshape(-1, s).T
        view[self.vertex, :, :, self.channel] = x[self.terms * s :].reshape(-1, w).T

    def maps(self, x):
        """Each sample's surface texel and its image's looked-up view map: [K, n] both."""
        s, w = self.sizes
        g, h = x[: self.terms * s].reshape(-1, s), x[self.terms * s :].reshape(-1, w)
        return g[:, self.texel], (h[:, self.view_texel] * self.view_weights).sum(2)[:, self.image]

    def residuals(self, x, bounds=True):
        """bounds: with their penalty."""
        g, h = self.maps(x)
        parts = [(g * h).sum(0) - self.target, self.smoothness @ x]
        if bounds:
            p, o = x[self.bounded], self.objective
            parts.append(o["mu"] ** 0.5 * (p - p.clip(o["lower"], o["upper"])))
        return np.concatenate(parts)

    def jacobian(self, x, bounds=True):
        """A sparse matrix."""
        g, h = self.maps(x)
        values = np.concatenate([h.T, (g[..., None] * self.view_weights[self.image]).transpose(1, 0, 2).reshape(g.shape[1], -1)], 1)
        parts = [scipy.sparse.csr_matrix((values.reshape(-1), self.columns, self.first), (len(self.target), len(x))), self.smoothness]
        if bounds:
            p, o = x[self.bounded], self.objective
            out = o["mu"] ** 0.5 * ((p < o["lower"]) | (p > o["upper"]))
            rows = np.arange(len(p))
            parts.append(scipy.sparse.csr_matrix((out, (rows, self.bounded)), (len(p), len(x))))
        return scipy.sparse.vstack(parts, "csr")

    def solve(self, **how):
        """(seconds, unknowns) of the start and each accepted step, at which the Jacobian is asked for. how: options of least_squares;
        where its method knows bounds, they are hard ones in place of their penalty."""
        hard, dense = how["method"] != "lm", how.get("tr_solver") != "lsmr"
        points, clock = [], time.perf_counter()

        def residuals(x):
            return self.residuals(x, not hard)

        def jacobian(x):
            if not points or (x != points[-1][1]).any():
                points.append((time.perf_counter() - clock, x.copy()))
            found = self.jacobian(x, not hard)
            return found.toarray() if dense else found

        limits, start = (-np.inf, np.inf), self.start
        if hard:
            low, high = np.full(len(start), -np.inf), np.full(len(start), np.inf)
            low[self.bounded], high[self.bounded] = self.objective["lower"], self.objective["upper"]
            limits = low, high
        found = scipy.optimize.least_squares(residuals, start, jacobian, limits, **how)
        return [*points, (time.perf_counter() - clock, found.x)]
