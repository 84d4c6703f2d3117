"""Why independent readers differ from ours: by kind, and by file where a person opened it."""

from __future__ import annotations

from collections.abc import Mapping

from fgenv.collision.mesh_files import FileMesh

AGREES, UNIT = "agrees", "ignores the unit"
REFUSES, READS = "refuses", "reads it"  # READS: a file that we refuse
CONFIRMING = {AGREES, UNIT}

# By reader, file and verdict, for files that were opened and looked at.
FILES: dict[tuple[str, str, str], str] = {
    ("assimp", "example-robot-data/hyq_description/meshes/trunk/trunk.dae", "volume"): (
        "a mirrored node, of which assimp does not turn the faces"
    ),
    **{
        (reader, "pybullet/random_urdfs/168/168.obj", READS): "the file has vertices of NaN"
        for reader in ("assimp", "meshio", "trimesh")
    },
    (
        "assimp",
        "rtb-data/xacro/kuka_description/kuka_lbr_iiwa/meshes/lbr_iiwa_14_r820/visual/"
        "base_link2.dae",
        READS,
    ): "the XML goes on after its end; trimesh refuses it too",
}


def explanation(
    label: str, reader: str, verdicts: Mapping[str, str], file: FileMesh | None
) -> str | None:
    """Return the reason for which a reader differs from ours, or None.

    Args:
        label: of the file.
        verdicts: of all readers.
        file: as we read it; None if we refuse it.
    """
    verdict = verdicts[reader]
    if verdict == UNIT:
        return "the reader leaves out the unit of the file; in it the measures agree"
    if reason := FILES.get((reader, label, verdict)):
        return reason
    confirmed = not CONFIRMING.isdisjoint(verdicts.values())
    if verdict.startswith(REFUSES) and (confirmed or file is None or file.polygons):
        return "the reader does not support the file"
    if verdict in ("area", "volume") and file is not None and file.polygons:
        if file.nonplanar:
            return "polygons that are not planar, which other diagonals cut"
        return "concave polygons, which the reader cuts as fans" if confirmed else None
    return None
