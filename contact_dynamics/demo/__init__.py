"""The demo: a recorded toss, played as published states; predictions beside what was then measured."""
