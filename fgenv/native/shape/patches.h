// Patches of faces within a slab: two parallel planes, every normal less than a right angle from
// theirs, and a one-to-one projection on them. A patch's borders are feature edges; what the graph
// can then miss is no deeper than the slabs are thick (proof in README, 'How it works').
#pragma once

#include "shape/mesh.h"

namespace fgenv {

// Patch of each face, slabs no thicker than `tolerance` meters.
std::vector<int32_t> grow_patches(const Mesh& mesh, double tolerance);

// The thickest slab of the patches that the kept edges cut the mesh into; infinite where one of
// them turns by a right angle or overlaps itself.
double patch_certificate(const Mesh& mesh, const std::vector<uint8_t>& kept);

}  // namespace fgenv
