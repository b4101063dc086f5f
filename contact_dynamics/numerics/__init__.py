"""Known numerical methods that the physics uses. They contain no physics."""
