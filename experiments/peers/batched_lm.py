"""Levenberg-Marquardt on all problems of a light field map at once, by PyTorch's batched matrices (torch.linalg).

A vertex and a channel are one problem, with its own damping and its own verdict on each step. Vertices that have as many
surface texels and are seen in about as many images stand together in a batch. Of the Gauss-Newton matrix

    [A      B W ]   g, the surface maps: A has a block for each triangle around the vertex, as nothing joins texels of two
    [W'B'  W'G W]   h, the view map, of which a residual knows what its image looks up, W h

the surface maps are eliminated (Schur complement). B and G are of images, which are fewer than view texels: factored are only the
blocks of A and one matrix as large as the view map, W' (G - B' A^-1 B) W. Smoothness and bounds are parts of A and of the latter.
By variable projection the surface maps then follow each trial of the view map in closed form.
"""
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import torch

from light_field import laplacian, numbers

GROWTH = 4  # of the damping by a rejected step; twice as much by each further one
LEAST_DAMPING = 1e-7
# Of surface maps that are projected: a triangle that no image shows has a singular block otherwise, and more than that is lost
# in 32 bits.
HELD = 1e-5
STATIONARY = 1e-7  # relative decrease of a problem's error by an accepted step that ends it


class Batch:
    """v vertices: n = 3 v problems, the channels of a vertex one behind the other. Sizes in shapes: d triangles around each with
    t texels, s = d t; at most i images; w view texels; K terms. g [n, d, K, t] and h [n, K, w] are surface and view maps."""

    def __init__(self, problem, vertices, images, samples):
        """images: at most so many of a vertex. samples: those in these vertices, by name: `vertex` and `image`, from 0 in this
        batch, `texel` of the vertex, and `view_texel`, `view_weights`, `targets` as Split has them."""
        a, about, dtype = problem.arrays, problem.about, problem.dtype
        self.objective, self.terms, side = problem.objective, about["maps"]["terms"], about["maps"]["surface_side"]
        first = torch.from_numpy(a["vertex_texels"])[vertices]
        v, s = len(vertices), int(a["vertex_texels"][vertices[0] + 1] - first[0])
        w, t = about["maps"]["view_side"] ** 2, side * (side + 1) // 2
        self.vertices, self.texels = vertices, (first[:, None] + torch.arange(s)).reshape(v, -1, t)
        vertex, image, texel = (samples[name] for name in ("vertex", "image", "texel"))
        self.seen = torch.zeros(v, images, s, dtype=dtype)  # 1: the image has a sample of the texel
        self.seen[vertex, image, texel] = 1
        if self.seen.sum() != len(vertex):
            raise ValueError("several samples of one texel in one image: not what these batches hold")
        self.targets = torch.zeros(v, 3, images, s, dtype=dtype)
        self.targets[vertex, :, image, texel] = samples["targets"]
        self.look_up = torch.zeros(v, images, w, dtype=dtype)  # W, scaled as the targets are
        self.look_up[vertex[:, None], image[:, None], samples["view_texel"]] = samples["view_weights"]
        neighbours = a["surface_neighbours"][first[0] : first[0] + t] - int(first[0])
        root = numbers(a["lambda_view"][vertices], dtype).sqrt().reshape(-1, 1, 1)
        self.surface_bent = self.objective["lambda_surface"] ** 0.5 * numbers(laplacian(neighbours), dtype)  # [t, t]
        self.view_bent = root * numbers(laplacian(a["view_neighbours"]), dtype)  # [n, w, w]
        self.surface_smooth, self.view_smooth = (x.mT @ x for x in (self.surface_bent, self.view_bent))

    def cut(self, surface, view):
        """g, h of exported maps."""
        g = surface[self.texels].permute(0, 4, 1, 3, 2).flatten(0, 1)
        return g.contiguous(), view[self.vertices].permute(0, 3, 2, 1).flatten(0, 1).contiguous()

    def paste(self, g, h, surface, view):
        """Into exported maps."""
        surface[self.texels] = g.unflatten(0, (-1, 3)).permute(0, 2, 4, 3, 1)
        view[self.vertices] = h.unflatten(0, (-1, 3)).permute(0, 3, 2, 1)

    def times(self, x, matrix):
        """x [n, .., r] by a vertex's matrix [v, r, c], all rows of its three problems at once: [n, .., c]."""
        return (x.reshape(len(matrix), -1, x.shape[-1]) @ matrix).reshape(*x.shape[:-1], -1)

    def beyond(self, x):
        """By how much parameters [.., K, p] are out of bounds, scaled; those of further terms have none."""
        first = x[..., :1, :]
        out = self.objective["mu"] ** 0.5 * (first - first.clamp(self.objective["lower"], self.objective["upper"]))
        return torch.nn.functional.pad(out, (0, 0, 0, self.terms - 1))

    def residuals(self, g, h):
        """Those of samples [n, i, s], of smoothness and of bounds [as g, as h, as g, as h]."""
        data = self.times(h, self.look_up.mT).mT @ g.transpose(1, 2).flatten(2)
        data.unflatten(0, (-1, 3)).mul_(self.seen[:, None]).sub_(self.targets)
        return [data, g @ self.surface_bent.mT, h @ self.view_bent.mT, self.beyond(g), self.beyond(h)]

    def errors(self, residuals):
        """[n]"""
        return 0.5 * sum(r.flatten(1).square().sum(1) for r in residuals)

    def surface_gradient(self, g, h, residuals):
        """Of the errors, as g."""
        data = (self.times(h, self.look_up.mT) @ residuals[0]).unflatten(2, g.shape[1::2]).transpose(1, 2)
        return data + residuals[1] @ self.surface_bent + self.objective["mu"] ** 0.5 * residuals[3]

    def view_gradient(self, g, residuals):
        """Of the errors, as h."""
        data = self.times(g.transpose(1, 2).flatten(2) @ residuals[0].mT, self.look_up)
        return data + residuals[2] @ self.view_bent + self.objective["mu"] ** 0.5 * residuals[4]

    def surface_block(self, g, h):
        """A [n, d, Kt, Kt]."""
        (n, d, k, t), images = g.shape, self.times(h, self.look_up.mT)
        sums = self.times(images[:, :, None] * images[:, None], self.seen).reshape(n, k, k, d, t)
        a = torch.diag_embed(sums.permute(0, 3, 1, 2, 4))  # [n, d, K, K, t, t]
        a.diagonal(dim1=2, dim2=3).add_(self.surface_smooth[..., None])
        a = a.transpose(3, 4).reshape(n, d, k * t, k * t)
        a.diagonal(dim1=2, dim2=3).add_(self.objective["mu"] * (self.beyond(g) != 0).flatten(2))
        return a

    def image_block(self, g):
        """G's K x K diagonals [n, K, K, i]."""
        g = g.transpose(1, 2).flatten(2)
        return self.times(g[:, :, None] * g[:, None], self.seen.mT)

    def joint_block(self, g, h):
        """B' [n, d, Ki, Kt]."""
        (n, d, k, t), images = g.shape, self.times(h, self.look_up.mT)
        seen = self.seen.unflatten(2, (d, t)).transpose(1, 2)[:, None, :, None, :, None]
        b = (g[:, :, :, None, None] * images.mT[:, None, None, :, :, None]).unflatten(0, (-1, 3)).mul_(seen)
        return b.reshape(n, d, -1, k * t)

    def view_block(self, h, x):
        """W' x W, and what smoothness and bounds add to it [n, Kw, Kw]; for x [n, Ki, Ki], symmetric."""
        n, k, w = h.shape
        half = self.times(x.unflatten(2, (k, -1)), self.look_up)  # [n, Ki, K, w]
        block = self.times(half.reshape(n, k, -1, k * w).mT, self.look_up).reshape(n, k, k, w, w)
        block.diagonal(dim1=1, dim2=2).add_(self.view_smooth[..., None])
        block = block.permute(0, 1, 4, 2, 3).reshape(n, k * w, k * w)
        block.diagonal(dim1=1, dim2=2).add_(self.objective["mu"] * (self.beyond(h) != 0).flatten(1))
        return block

    def step(self, g, h, damping, project):
        """Trial maps g, h, and the decreases of the errors that the linear model foresees; for damping [n] of the diagonal. Where a
        matrix is not positive definite in 32 bits, they are no numbers, and the trial is rejected."""
        n, k, w = h.shape
        residuals = self.residuals(g, h)
        surface, view = self.surface_gradient(g, h, residuals).flatten(2), self.view_gradient(g, residuals).flatten(1)
        a, of_images = self.surface_block(g, h), self.image_block(g)
        held_surface = (HELD if project else damping[:, None, None]) * a.diagonal(dim1=2, dim2=3)
        held_view = self.times(of_images.diagonal(dim1=1, dim2=2).mT, self.look_up.square())
        held_view = damping[:, None] * (held_view + self.view_smooth.diagonal(dim1=1, dim2=2)[:, None]).flatten(1)
        a.diagonal(dim1=2, dim2=3).add_(held_surface)
        factor = torch.linalg.cholesky_ex(a)[0]
        rows = torch.cat([self.joint_block(g, h), surface[:, :, None]], 2)  # [n, d, Ki + 1, Kt]
        rows = torch.linalg.solve_triangular(factor, rows.mT, upper=False).mT.transpose(1, 2).flatten(2)  # [n, Ki + 1, dKt]
        of_images = torch.diag_embed(of_images).transpose(2, 3).reshape(n, rows.shape[1] - 1, -1)
        eliminated = rows @ rows.mT
        left = self.view_block(h, of_images - eliminated[:, :-1, :-1])
        left.diagonal(dim1=1, dim2=2).add_(held_view)
        right = self.times(eliminated[:, :-1, -1].reshape(n, k, -1), self.look_up).flatten(1) - view
        dh = torch.cholesky_solve(right[..., None], torch.linalg.cholesky_ex(left)[0])[..., 0]
        of_dh = self.times(dh.reshape(h.shape), self.look_up.mT).reshape(n, 1, -1)
        dg = (rows[:, -1:] + of_dh @ rows[:, :-1]).reshape(*surface.shape, 1)
        dg = -torch.linalg.solve_triangular(factor.mT, dg, upper=True)[..., 0]
        foreseen = 0.5 * ((held_surface * dg - surface) * dg).sum((1, 2)) + 0.5 * ((held_view * dh - view) * dh).sum(1)
        g, h = g + dg.reshape(g.shape), h + dh.reshape(h.shape)
        return self.projected(g, h) if project else g, h, foreseen

    def projected(self, g, h):
        """Surface maps that minimize the error for view map h, the bounds as g has them."""
        a = self.surface_block(g, h)
        a.diagonal(dim1=2, dim2=3).mul_(1 + HELD)
        factor = torch.linalg.cholesky_ex(a)[0]
        gradient = self.surface_gradient(g, h, self.residuals(g, h)).flatten(2)[..., None]
        return g - torch.cholesky_solve(gradient, factor).reshape(g.shape)


def batches(problem, vertices):
    """All problems of a LightField in batches of at most so many vertices."""
    a, split = problem.arrays, problem.training
    triangle, image = a["training_group_triangle"], a["training_group_image"]
    group = np.repeat(np.arange(len(triangle)), np.diff(a["training_group_first"]))  # of each sample
    owner = a["triangle_vertices"][triangle].astype(np.int64)  # [groups, 3 corners]
    # Images are counted anew for each vertex, those that have no sample of it left out.
    images = a["training_weight"].shape[1]
    pairs, rank = np.unique(owner * images + image[:, None], return_inverse=True)
    first_pair = np.searchsorted(pairs, np.arange(len(a["inverse_density"]) + 1) * images)
    rank, count = rank.reshape(owner.shape) - first_pair[owner], np.diff(first_pair)
    texel = a["triangle_maps"][triangle][group] + a["training_texel"][:, None] - a["vertex_texels"][owner[group]]
    view_texel = split.view_texel.reshape(*owner.shape, 4) - torch.from_numpy(owner)[..., None] * problem.start[1].shape[1]
    order = np.argsort(owner[group].reshape(-1), kind="stable")  # samples and corners, by vertex
    first = np.searchsorted(owner[group].reshape(-1)[order], np.arange(len(count) + 1))
    surface = np.diff(a["vertex_texels"])
    solved = np.flatnonzero((count > 0) & (a["inverse_density"] > 0))
    solved = solved[np.lexsort((count[solved], surface[solved]))]
    sizes = np.unique(surface[solved], return_index=True)[1].tolist() + [len(solved)]
    cuts = [c for one, next in zip(sizes, sizes[1:]) for c in range(one, next, vertices)]
    made = []
    for some in np.split(solved, cuts[1:]):
        rows = np.concatenate([order[first[v] : first[v + 1]] for v in some])
        at = 3 * group[rows // 3] + rows % 3  # group and corner
        samples = {"vertex": np.repeat(np.arange(len(some)), first[some + 1] - first[some]), "image": rank.reshape(-1)[at],
                   "texel": texel.reshape(-1)[rows]}  # fmt: skip
        samples = {name: torch.from_numpy(x) for name, x in samples.items()}
        samples |= {"view_texel": view_texel.reshape(-1, 4)[at], "view_weights": split.view_weights[at, :, 0],
                    "targets": split.targets.reshape(-1, 3)[rows]}  # fmt: skip
        made.append(Batch(problem, some, int(count[some].max()), samples))
    return made


class Descent:
    """Where the problems of a batch are: maps, errors, damping, and which of them still move."""

    def __init__(self, batch, surface, view, damping):
        self.batch = batch
        self.g, self.h = batch.cut(surface, view)
        self.error = batch.errors(batch.residuals(self.g, self.h))
        self.damping, self.growth = torch.full_like(self.error, damping), torch.full_like(self.error, GROWTH)
        self.active = torch.ones_like(self.error, dtype=torch.bool)

    def step(self, project):
        if not self.active.any():
            return
        g, h, foreseen = self.batch.step(self.g, self.h, self.damping, project)
        after = self.batch.errors(self.batch.residuals(g, h))
        ratio = (self.error - after) / foreseen
        accepted = self.active & (after < self.error)
        done = (accepted & (self.error - after <= STATIONARY * self.error)) | (foreseen <= 1e-12 * self.error)
        eased = (self.damping * (1 - (2 * ratio - 1) ** 3).clamp(min=0.03)).clamp(min=LEAST_DAMPING)
        self.damping = torch.where(ratio > 0, eased, self.damping * self.growth)
        self.growth = torch.where(ratio > 0, GROWTH, 2 * self.growth)
        self.g = torch.where(accepted[:, None, None, None], g, self.g)
        self.h = torch.where(accepted[:, None, None], h, self.h)
        self.error = torch.where(accepted, after, self.error)
        self.active &= ~done


def levenberg_marquardt(problem, clock, all, damping, project):
    """Yields the maps after every step of all problems. all: batches(); project: by variable projection."""
    surface, view = [p.clone() for p in problem.start]
    threads = torch.get_num_threads()
    # Batched factorizations are loops in one thread, so each thread takes batches of its own.
    with ThreadPoolExecutor(threads, initializer=lambda: torch.set_num_threads(1)) as pool:
        descents = list(pool.map(lambda batch: Descent(batch, surface, view, damping), all))
        torch.set_num_threads(threads)
        while True:
            list(pool.map(lambda descent: descent.step(project), descents))
            for descent in descents:
                descent.batch.paste(descent.g, descent.h, surface, view)
            yield [surface.clone(), view.clone()]
