"""Known numerical methods that the physics uses; no physics."""
