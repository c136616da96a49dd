"""A guidance agent that learns to keep the lane, by random search.

    python examples/agents/keep_lane.py [EPISODES]

The agent's torque is linear in three signals. Each episode tries other weights on the
same driver and keeps them if they earned more. Any library that takes a Gymnasium
environment could learn here instead.
"""

from __future__ import annotations

import sys

import numpy as np

from costeer.environment.steering import SteeringEnvironment
from costeer.loop.scenario import TrialSetup

SETUP = TrialSetup(
    condition="strong-normal",
    intention="off",
    events=False,
    initial_offset=0.8,
    length=100.0,
)
SEEN = ("lateral_position", "yaw_angle", "yaw_rate")


def earned(environment: SteeringEnvironment, weights: np.ndarray) -> float:
    """Reward of one episode, always the same one [s]."""
    names = [each.name for each in environment.signals]
    used = [names.index(name) for name in SEEN]
    seen, _ = environment.reset(seed=1)
    total, over = 0.0, False
    while not over:
        action = np.clip(weights @ seen[used], -1.0, 1.0)
        seen, reward, crashed, arrived, _ = environment.step(np.array([action]))
        total, over = total + reward, crashed or arrived
    return total


def main(episodes: int) -> None:
    """Search, and print what was found."""
    environment = SteeringEnvironment("guidance", SETUP)
    draws = np.random.default_rng(1)
    best = np.zeros(len(SEEN))
    most = start = earned(environment, best)
    for _ in range(episodes):
        tried = best + draws.normal(scale=(0.3, 2.0, 1.0))
        reward = earned(environment, tried)
        if reward > most:
            best, most = tried, reward
    print(f"without guidance {start:.2f} s, after {episodes} episodes {most:.2f} s")
    print(", ".join(f"{n} {w:.2f}" for n, w in zip(SEEN, best, strict=True)))


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
