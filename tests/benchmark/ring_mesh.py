"""A mesh of any number of triangles."""
import numpy


def write_ring(path, around=1000, across=500):
    """Writes a ring with bumps and hollows, 2 x around x across triangles, as binary STL."""
    turns = (2 * numpy.pi / n * (numpy.arange(n + 1) % n) for n in (around, across))  # the ring closes to the bit
    u, v = numpy.meshgrid(*turns, indexing="ij")
    tube = 0.25 + 0.02 * numpy.sin(7 * u) * numpy.cos(5 * v)
    points = numpy.stack([(0.65 + tube * numpy.cos(v)) * numpy.cos(u), (0.65 + tube * numpy.cos(v)) * numpy.sin(u),
                          tube * numpy.sin(v)], axis=-1)
    corners = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
    facets = numpy.zeros((2, around, across), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    facets["corners"][0] = numpy.stack([corners[i] for i in (0, 1, 2)], axis=-2)
    facets["corners"][1] = numpy.stack([corners[i] for i in (0, 2, 3)], axis=-2)
    path.write_bytes(bytes(80) + numpy.uint32(facets.size).tobytes() + facets.tobytes())
