"""Parts that the benchmarks share: meshes, poses, timing, ground truth."""
