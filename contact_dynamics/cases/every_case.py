"""All cases, by the names that the command line takes, in the order of the page."""

from __future__ import annotations

from typing import Final

from contact_dynamics.cases import (
    bounce,
    bowling_ball,
    cradle,
    creeping_capsule,
    flip_period,
    four_feet,
    free_fall,
    friction_angle,
    hour_of_spin,
    hundred_bounces,
    jamming_drawer,
    ladder,
    oblique_sliding,
    painleve_rod,
    pressed_book,
    rolling_down,
    spinning_bounce,
    tipping_cube,
    turning_bar,
    two_balls,
)

CASES: Final = {
    "creeping_capsule": creeping_capsule.CASE,
    "friction_angle": friction_angle.CASE,
    "pressed_book": pressed_book.CASE,
    "turning_bar": turning_bar.CASE,
    "ladder": ladder.CASE,
    "jamming_drawer": jamming_drawer.CASE,
    "four_feet": four_feet.CASE,
    "tipping_cube": tipping_cube.CASE,
    "oblique_sliding": oblique_sliding.CASE,
    "bowling_ball": bowling_ball.CASE,
    "rolling_down": rolling_down.CASE,
    "bounce": bounce.CASE,
    "hundred_bounces": hundred_bounces.CASE,
    "spinning_bounce": spinning_bounce.CASE,
    "two_balls": two_balls.CASE,
    "cradle_in_turn": cradle.IN_TURN,
    "cradle_at_once": cradle.AT_ONCE,
    "painleve_rod": painleve_rod.CASE,
    "free_fall": free_fall.CASE,
    "flip_period": flip_period.CASE,
    "hour_of_spin": hour_of_spin.CASE,
}
