"""Versions of a plan: each is kept whole, with its scenarios, and never changed."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping

from costeer.scenarios.definition import Scenario
from costeer.scenarios.reading import scenario_named
from costeer.sessions.plan import Plan, plan_hash
from costeer.sessions.plan_file import kept_plan
from costeer.sessions.scenarios import is_file_name, scenario_in
from costeer.sessions.store import Store, now


class PlanVersions:
    """The plans that a study has had.

    Args:
        store: Of the study.
    """

    def __init__(self, store: Store) -> None:
        self._store = store
        self._plans: dict[int, Plan] = {}
        self._scenarios: dict[tuple[int, str], Scenario] = {}

    def known(self, plan: Plan, text: str, scenarios: Mapping[str, str]) -> int:
        """Version of a plan, kept when it is new.

        Args:
            plan: As it was read.
            text: Of its file.
            scenarios: Text of each by its name.

        Raises:
            StoreError: If it cannot be kept.
        """
        digest = plan_hash(plan, scenarios)
        found = self._store.rows("SELECT version FROM plans WHERE hash = ?", digest)
        if found:
            return int(found[0]["version"])
        (last,) = self._store.rows("SELECT coalesce(max(version), 0) AS n FROM plans")
        version = int(last["n"]) + 1
        row = {"version": version, "hash": digest, "text": text, "utc": now().utc}
        with self._store.transaction():
            self._store.put("plans", row)
            for name, file in scenarios.items():
                kept = {"version": version, "name": name, "text": file}
                self._store.put("scenarios", kept)
            self._store.tell("plan", f"version {version}", data={"hash": digest})
        return version

    def plan(self, version: int) -> Plan:
        """A plan as it was."""
        if version not in self._plans:
            rows = self._store.rows("SELECT text FROM plans WHERE version = ?", version)
            self._plans[version] = kept_plan(rows[0]["text"], f"plan {version}")
        return self._plans[version]

    def scenario(self, version: int, name: str) -> Scenario:
        """A scenario of a plan as it was."""
        if (version, name) not in self._scenarios:
            rows = self._store.rows(
                "SELECT text FROM scenarios WHERE version = ? AND name = ?",
                *(version, name),
            )
            found = scenario_in(rows[0]["text"], name) if rows else scenario_named(name)
            self._scenarios[version, name] = found
        return self._scenarios[version, name]

    def scenario_hash(self, version: int, name: str) -> str:
        """What tells editions of a lab's scenario apart; empty for one that ships."""
        rows = self._store.rows(
            "SELECT text FROM scenarios WHERE version = ? AND name = ?",
            *(version, name),
        )
        if not rows or not is_file_name(name):
            return ""
        return hashlib.sha256(str(rows[0]["text"]).encode()).hexdigest()[:8]

    def hashes(self) -> dict[int, str]:
        """What tells the versions apart."""
        rows = self._store.rows("SELECT version, hash FROM plans")
        return {int(row["version"]): str(row["hash"]) for row in rows}
