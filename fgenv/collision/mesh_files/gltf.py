"""glTF 2.0 files, binary (.glb) or text (.gltf): the geometry of the scene, in meters, y up."""

from __future__ import annotations

from .content import FileMesh, MeshSource, Unit
from .gltf_container import parse_document
from .gltf_document import GltfDocument
from .gltf_nodes import place_nodes, scene_roots
from .scene_parts import SceneParts

METER = Unit("meter", 1.0)  # by the format
# Extensions that change appearance, metadata or encodings that are read anyway.
HARMLESS = (
    "KHR_mesh_quantization",
    "EXT_mesh_gpu_instancing",
    "KHR_materials_",
    "KHR_texture_",
    "KHR_lights_",
    "KHR_techniques_webgl",
    "KHR_xmp",
    "KHR_animation_pointer",
    "EXT_texture_",
    "EXT_lights_",
    "EXT_materials_",
    "MSFT_texture_",
    "MSFT_packing_",
)


def read_gltf(source: MeshSource) -> FileMesh:
    """Read the default scene of a glTF file: triangles, placed by the nodes.

    Instances, morph targets at their weights, and skins at the pose of their joints are applied.
    Other scenes, unused meshes, lines, points, and animations are noted.

    Raises:
        ValueError: invalid or truncated content, compressed geometry, or an unknown required
            extension.
    """
    document = parse_document(source)
    _check_extensions(document)
    parts = SceneParts(source)
    place_nodes(document, scene_roots(document, parts), parts)
    _note_rest(document, parts)
    kind = "GLB" if document.binary else "glTF"
    return FileMesh(kind, *parts.joined(), unit=METER, up="y", notes=tuple(parts.notes))


def _check_extensions(document: GltfDocument) -> None:
    for name in document.names("extensionsRequired"):
        document.refuse_compression({name: {}}, "geometry")
        if not name.startswith(HARMLESS):
            document.source.fail(
                f"the required extension {name[:60]!r}",
                "core glTF 2.0; export without this extension",
            )


def _note_rest(document: GltfDocument, parts: SceneParts) -> None:
    """Note the parts of the document that the mesh lacks."""
    unused = set(range(len(document.items("meshes")))) - document.used["meshes"]
    if unused:
        parts.note(f"{len(unused)} meshes are not in the scene, and are skipped.")
    if document.items("animations"):
        parts.note("Animations are not applied; the mesh has the pose of the nodes.")
    for name in sorted(document.skipped_extensions):
        parts.note(f"The optional extension {name} is not read.")
