"""The problems of a light field map (docs/problems.md), all vertices in one graph of PyTorch's."""
import json

import numpy as np
import torch


def numbers(array, dtype):
    return torch.from_numpy(np.ascontiguousarray(array)).to(dtype)


def laplacian(neighbours):
    """[p, p], of a map whose p texels have these four neighbours each."""
    each = np.eye(len(neighbours))
    return 4 * each - each[neighbours].sum(1)


class Split:
    """The samples of one split. Look-ups are flat indices, a colour channel each: of gathers and their gradients, those in one
    dimension are PyTorch's fastest by far."""

    def __init__(self, name, a, about, dtype, scaled):
        """a: the exported arrays. scaled: products and targets are multiplied by the root of what their squares count."""
        terms, m = about["maps"]["terms"], about["maps"]["view_side"]
        triangle, image = a[name + "_group_triangle"], a[name + "_group_image"][:, None]
        vertex = a["triangle_vertices"][triangle]  # [groups, 3 corners]
        group = np.repeat(np.arange(len(triangle)), np.diff(a[name + "_group_first"]))  # of each sample
        texel = a["triangle_maps"][triangle][group] + a[name + "_texel"][:, None]  # [samples, 3 corners]
        looked_up = vertex * m * m + a[name + "_view_texel"][vertex, image]
        weights = a[name + "_view_weights"][vertex, image]
        targets = a["barycentric"][texel][..., None] * a[name + "_radiance"][:, None]
        if scaled:
            root = np.sqrt(a["inverse_density"][vertex] * a[name + "_weight"][vertex, image])
            weights = weights * root[..., None]
            targets = targets * root[group][..., None]
        channel = np.arange(3)
        corner = 3 * group[:, None] + np.arange(3)
        self.terms = terms
        self.view_texel = numbers(looked_up[..., None] + [0, 1, m, m + 1], torch.int64).reshape(-1, 4)
        self.view_weights = numbers(weights, dtype).reshape(-1, 4, 1)
        self.surface_at = numbers(texel[..., None] * 3 * terms + channel, torch.int64).reshape(-1)
        self.h_at = numbers(corner[..., None] * 3 * terms + channel, torch.int64).reshape(-1)
        self.targets = numbers(targets, dtype).reshape(-1)  # [samples, 3 corners, 3 channels]

    def products(self, surface, view):
        """sum over terms of g h, as the targets stand. surface, view: as exported."""
        texels = view.reshape(-1, 3 * self.terms)
        h = (torch.nn.functional.embedding(self.view_texel, texels) * self.view_weights).sum(1).reshape(-1)
        g = surface.reshape(-1)
        parts = (g[3 * k :].gather(0, self.surface_at) * h[3 * k :].gather(0, self.h_at) for k in range(self.terms))
        return sum(parts)


class LightField:
    """E over the training samples, and how well held-out ones are predicted."""

    def __init__(self, folder, dtype=torch.float32):
        with open(f"{folder}/problems.json", encoding="utf-8") as file:
            about = json.load(file)
        a = {name: np.load(f"{folder}/{name}.npy") for name in about["arrays"]}
        self.arrays, self.about = a, about
        self.dtype, self.objective, self.digest = dtype, about["objective"], about["dataset"]["digest"]
        self.start = [numbers(a["start_" + map], dtype) for map in ("surface", "view")]
        self.training = Split("training", a, about, dtype, scaled=True)
        self.held_out = Split("held_out", a, about, dtype, scaled=False)
        self.radiance = numbers(a["held_out_radiance"], torch.float64)
        row, channel = 3 * about["maps"]["terms"], np.arange(3 * about["maps"]["terms"])
        self.surface_neighbours = numbers(a["surface_neighbours"].T[..., None] * row + channel, torch.int64).reshape(4, -1)
        self.view_neighbours = numbers(a["view_neighbours"].T, torch.int64)
        self.lambda_view = numbers(a["lambda_view"], dtype)[:, None, None]

    def read(self, folder):
        """Parameters that `radiafit export parameters` wrote, of the same dataset."""
        with open(f"{folder}/parameters.json", encoding="utf-8") as file:
            digest = json.load(file)["dataset"]["digest"]
        if digest != self.digest:
            raise ValueError(f"{folder}: of another dataset than the problems")
        return [numbers(np.load(f"{folder}/{map}.npy"), self.dtype) for map in ("surface", "view")]

    def bounds(self, p):
        o = self.objective
        beyond = p - p.clamp(o["lower"], o["upper"])
        if not o["printed_bounds"]:
            return 0.5 * o["mu"] * beyond.square().sum()
        return o["mu"] * ((p - o["lower"]) * (p - o["upper"]) * (beyond != 0)).sum()

    def error(self, surface, view):
        """E of all problems."""
        data = torch.nn.functional.mse_loss(self.training.products(surface, view), self.training.targets, reduction="sum")
        flat = surface.reshape(-1)
        bent = 4 * flat - sum(flat.gather(0, neighbours) for neighbours in self.surface_neighbours)
        view_bent = 4 * view - sum(view.index_select(1, neighbours) for neighbours in self.view_neighbours)
        smoothness = self.objective["lambda_surface"] * bent.square().sum() + (self.lambda_view * view_bent.square()).sum()
        return 0.5 * (data + smoothness) + self.bounds(surface[:, 0]) + self.bounds(view[:, :, 0])

    @torch.no_grad()
    def psnr(self, surface, view, samples=slice(None)):
        """Of held-out samples, in dB."""
        values = self.held_out.products(surface, view).reshape(-1, 3, 3)[samples].sum(1).clamp(0, 1)
        return -10 * torch.log10((values - self.radiance[samples]).square().mean()).item()
