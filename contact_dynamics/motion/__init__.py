"""Motion under gravity, wrenches and drag: integrated, differentiated, fitted, with covariances."""
