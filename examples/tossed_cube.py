# SPDX-License-Identifier: Apache-2.0
"""Where does a tossed cube come to rest, and what can happen on the way?  It prints the tree of its strikes.

The state is known to 2 mm, 1 degree, 2 cm/s and 0.3 rad/s. Impacts differ from Routh's by a spread, which
`contact-dynamics calibrate` finds on recorded tosses.
"""

from __future__ import annotations

import numpy as np

from contact_dynamics import Body, BodyState, Surface, World
from contact_dynamics.diagrams.words import branch_in_words, face_in_words
from contact_dynamics.questions import Context, TossQuestion, TossSampling, UncertainState, ask
from contact_dynamics.toss import TossUncertainty
from contact_dynamics.toss.distribution import Branch

SIZE = (0.1, 0.1, 0.1)
CUBE = Body.box(SIZE, mass=0.37, name="cube")
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.2, restitution=0.15)

thrown = BodyState(
    p_WB_W=[0, 0, 0.2], q_WB=[0.3, 0.2, 0.1, 0.9273618495], v_WB_W=[0.5, 0.3, 0.5], w_WB_W=[2, -4, 1]
)
deviations = [0.002] * 3 + [0.02] * 3 + [0.02] * 3 + [0.3] * 3
question = TossQuestion(
    body=CUBE,
    state=UncertainState(state=thrown, covariance=np.diag(deviations) ** 2),
    sampling=TossSampling(count=100, to_rest=True, uncertainty=TossUncertainty(velocity=0.02, spin=0.4)),
)
answer = ask(question, Context(world=World(surfaces=(FLOOR,))))

went, told = answer.toss, answer.distribution
if told is None:
    raise SystemExit("there are no samples")
place = went.trajectory.p_WB_W[-1].round(2)
print(f"from the best state, the toss {went.end.name.lower()} after {went.seconds:.2f} s at {place} m")
print(f"what {told.samples} samples do:")


def print_branches(branches: tuple[Branch, ...], parent: int) -> None:
    """Print the branches that follow one, each with those that follow it."""
    for k, branch in enumerate(branches):
        if branch.parent == parent:
            what = branch_in_words(branch.kind, branch.corner)
            when = "" if branch.regions is None else f", in {branch.regions.seconds.mean[0]:.3f} s on average"
            print(f"{'  ' * branch.strike}{branch.strike}. {what}: {branch.probability:.0%}{when}")
            print_branches(branches, k)


print_branches(told.branches, -1)
for normal, share in zip(told.face_normals_B, told.face_probabilities, strict=True):
    print(f"  rests on the face towards {face_in_words(normal)}: {share:.0%}")
