"""Ways to compute the same hop and the same stride, one module each; `benchmarks.engines` compares them."""
