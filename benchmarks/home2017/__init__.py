"""Acoustics and descriptions of HoME (2017), reproduced for comparison with this simulator.

`python -m benchmarks.home2017 [HOUSE] [--dataset ROOT]` prints the descriptions of a house's objects by HoME's rules.
Brodeur et al., HoME: a Household Multimodal Environment, arXiv:1711.11017.
"""
