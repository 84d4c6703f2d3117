"""Laws between the results of the queries, for all meshes and poses.

Exact worlds (small dyadic numbers, a cube's rotations) round nothing: there every law is strict.
Elsewhere placing a vertex rounds it, so that a law may fail where the bodies touch within
`allowance`: 1e-11 of the largest length about, some thousand times what a double is rounded by.
"""

from __future__ import annotations

import numpy as np
import pytest
from oracles.rational import meshes_meet

from fgenv.arrays import Floats
from fgenv.collision import Shape, collide, contact_point, distance, nearest_points

Placed = tuple[Shape, Floats]


def allowance(a: Placed, b: Placed, exact: bool) -> float:
    """Distance (meters) within which a touch may or may not be reported."""
    reaches = [np.abs(s.vertices).max() + np.abs(T[:3, 3]).max() for s, T in (a, b)]
    return 1e-10 if exact else max(1e-11 * max(reaches), 1e-150)  # squares of less are 0


def of_collide(a: Placed, b: Placed, exact: bool) -> None:
    """Symmetric, exact in an exact world, free only at a distance, for every form of query."""
    hit, back = collide(*a, *b), collide(*b, *a)
    gap = distance(*a, *b)
    near = allowance(a, b, exact)
    if a[0].method == b[0].method == "exact":
        touch = not exact and max(gap, distance(*b, *a)) <= near
        assert hit == back or touch, (hit, back, gap)
        assert not hit or gap == 0, gap
        assert hit or gap > 0 or (not exact and collide(*a, *b, margin=near)), gap
        if exact:
            meet = meshes_meet(a[0].vertices, a[0].faces, a[1], b[0].vertices, b[0].faces, b[1])
            found = contact_point(*a, *b)
            assert hit or not meet, "missed"
            assert meet or not hit or (found is not None and found.edge is None), "false hit"
    elif "loop" not in (a[0].method, b[0].method):
        assert not hit or gap <= near, f"false hit at {gap}"


def of_contact(a: Placed, b: Placed, exact: bool) -> None:
    """A contact exists exactly for a collision; its features exist; the point is on both bodies."""
    found = contact_point(*a, *b)
    assert (found is not None) == collide(*a, *b)
    if found is None:
        return
    assert np.isfinite(found.point).all()
    assert np.isfinite(found.normal).all()
    length = np.linalg.norm(found.normal)
    assert abs(length - 1) < 1e-9 or length == 0, length
    assert (found.edge is None) == (found.face is None) == (found.edge_of is None)
    if found.face is not None:
        assert 0 <= found.face < len((b if found.edge_of == "a" else a)[0].faces)


def of_distance(a: Placed, b: Placed, exact: bool) -> None:
    """nearest agrees with distance bit for bit; its points are that far apart; symmetric."""
    gap, found = distance(*a, *b), nearest_points(*a, *b)
    assert np.isfinite(gap)
    assert gap >= 0
    assert gap == found.distance, (gap, found.distance)
    assert np.isfinite(found.point_a).all()
    assert np.isfinite(found.point_b).all()
    near = 1e4 * allowance(a, b, exact) + 1e-9 * gap  # the normal of a sliver has few digits
    apart = np.linalg.norm(found.point_a - found.point_b)
    assert abs(apart - gap) <= near, (apart, gap)
    back = distance(*b, *a)
    assert abs(back - gap) <= near or min(back, gap) == 0, (gap, back)
    if gap > near and gap > 1e-150:
        assert abs(np.linalg.norm(found.normal) - 1) < 1e-6
        lead = (found.point_a - found.point_b) / apart - found.normal
        assert np.abs(lead).max() <= 1e-6 + near / gap, "normal not from b to a"


def of_margin(a: Placed, b: Placed, margins: list[float], exact: bool) -> None:
    """A larger margin never turns a collision free; the critical margin is the distance."""
    del exact
    gap = float(distance(*a, *b))
    if "loop" in (a[0].method, b[0].method):  # unsound, but over 0 a margin is exact
        margins = [margin for margin in margins if margin > 0]
    results = [collide(*a, *b, margin=margin) for margin in sorted(margins)]
    assert results == sorted(results), "not monotone"
    if not gap:
        assert collide(*a, *b, margin=1e-150)  # with a square above 0
    elif gap > 1e-150:
        assert collide(*a, *b, margin=gap * (1 + 1e-12)), gap
        assert not collide(*a, *b, margin=gap * (1 - 1e-12)), gap


def of_many(a: Placed, b: Placed, other: Floats) -> None:
    """An array of poses has the results of its single poses, for any number of threads."""
    poses = np.stack([b[1], other, b[1]])
    for query in (collide, distance):
        one = [query(*a, b[0], T) for T in poses]
        for threads in (1, 2):
            assert np.array_equal(query(*a, b[0], poses, threads=threads), one)


def of_rays(a: Placed, origins: Floats, directions: Floats, reach: float) -> None:
    """Hits lie on the reported face, within reach; a smaller reach keeps all nearer hits."""
    shape, T = a
    at, faces = shape.raycast(origins, directions, T)
    assert ((faces >= 0) == np.isfinite(at)).all()
    assert (at >= 0).all()
    assert (faces < len(shape.faces)).all()
    short, named = shape.raycast(origins, directions, T, reach)
    assert (short <= reach)[named >= 0].all()
    kept = at <= reach
    assert np.array_equal(short[kept], at[kept])
    assert np.array_equal(named[kept], faces[kept])
    assert (named[~kept] == -1).all()


def of_contains(a: Placed, points: Floats) -> None:
    """Only for a solid: its vertices are inside, points beyond its bounds are not."""
    shape, T = a
    if not shape.watertight:
        with pytest.raises(ValueError, match="watertight"):
            shape.contains(points, T)
        return
    inside = shape.contains(points, np.eye(4))
    low, high = shape.bounds
    assert not inside[((points < low) | (points > high)).any(axis=1)].any()
    assert shape.contains(shape.vertices).all(), "a vertex is on the surface"


def of_graph(shape: Shape) -> None:
    """Edges between points, each once; the packed matrix says the same."""
    graph = shape.graph
    n = len(graph.points)
    assert len(graph.kinds) == len(graph.edges)
    assert len(graph.adjacency) == (n * (n - 1) // 2 + 7) // 8
    if len(graph.edges):
        assert graph.edges.min() >= 0
        assert graph.edges.max() < n
    matrix = graph.dense()
    upper = np.unpackbits(graph.adjacency)[: n * (n - 1) // 2].astype(bool)
    assert np.array_equal(matrix[np.triu_indices(n, 1)], upper)
    assert graph.method == "loop" or matrix.sum() == 2 * len(graph.edges)


def of_reading_again(shape: Shape) -> None:
    """A repaired mesh needs no repair; but one with a single side (Moebius) is wound anew."""
    again = Shape(shape.vertices, shape.faces)
    done = again.repairs.copy()
    flipped = done.pop("flipped_faces")
    assert not any(done.values()), done
    assert not flipped or not shape.watertight, "a solid has two sides"
    assert flipped or np.array_equal(again.faces, shape.faces)
    assert np.array_equal(again.vertices, shape.vertices)
