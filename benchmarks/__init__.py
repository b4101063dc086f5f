"""The benchmarks measure speed and accuracy, and run peers beside us: `python -m benchmarks`."""
