"""Speed and accuracy, with peers beside us: `python -m benchmarks`."""
