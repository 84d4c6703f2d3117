"""The published method in NumPy, the baselines of its comparison, its experiment and its figures.

- `method`: the published feature-graph algorithm, section by section; the oracle of the native
  method `loop`.
- `baselines`: boxes, sphere, hull and grid, which `fgenv compare` measures against the graphs.
- `scene`, `timed_path`, `drive`, `replanning`, `experiment`: the published experiment on a `World`:
  path masks, certified motion, OMPL's RRTConnect and the certificate of its path.
- `report`, `figures`: the experiment as text, as JSON and as the paper's figures.

Only `fgenv.bench` and `fgenv.cli` import this package.
"""
