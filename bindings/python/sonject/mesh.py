"""Meshes in memory as files that scenes can name."""

from __future__ import annotations

import os
from typing import Any

import numpy

from ._values import PathLike, file_name


def write_mesh(path: PathLike, vertices: Any, faces: Any) -> str:
    """Writes a PLY file of triangles, whole or not at all, and returns its name, for a scene's key:

    >>> scene["objects[0]"] = {"shape": "mesh", "mesh": write_mesh("rock.ply", vertices, faces)}

    vertices: points x 3, in m unless the scene has a unit. faces: triangles x 3, numbers of
    vertices from 0.
    """
    points, corners = numpy.asarray(vertices), numpy.asarray(faces)
    for name, array, kinds in (("vertices", points, "fiu"), ("faces", corners, "iu")):
        if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in kinds or not array.size:
            raise ValueError(f"{name} must have rows of three {'whole ' * (kinds == 'iu')}numbers, "
                             f"not the shape {array.shape} of {array.dtype}")
    if not numpy.all(numpy.isfinite(points)):
        raise ValueError("vertices must be finite numbers")
    if corners.min() < 0 or corners.max() >= len(points):
        raise ValueError(f"faces must be numbers of vertices, 0...{len(points) - 1}, "
                         f"not {corners.min()}...{corners.max()}")
    name = os.fsdecode(file_name("path", path))
    if not name.lower().endswith(".ply"):
        raise ValueError(f"a mesh is written as .ply, not to {name}")
    rows = numpy.empty(len(corners), [("count", "u1"), ("corners", "<u4", 3)])
    rows["count"], rows["corners"] = 3, corners
    head = ("ply\nformat binary_little_endian 1.0\n"
            f"element vertex {len(points)}\n" + "".join(f"property double {axis}\n" for axis in "xyz")
            + f"element face {len(corners)}\nproperty list uchar uint vertex_indices\nend_header\n")
    with open(name + ".part", "wb") as file:
        file.write(head.encode("ascii") + points.astype("<f8").tobytes() + rows.tobytes())
    os.replace(name + ".part", name)  # whole or not at all
    return name
