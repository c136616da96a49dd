"""NASA-TLX from people; virtual drivers have no subjective workload."""

from __future__ import annotations

from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.study.figures import bars
from costeer.study.material import StudyMaterial, is_virtual
from costeer.study.quantities import WORKLOAD

NAME = "workload"
TITLE = "NASA-TLX"


def draw(material: StudyMaterial) -> list[Exhibit]:
    """Draw raw and weighted scores, or say why there are none."""
    answered = [
        each
        for each in WORKLOAD
        if each.name in material.trials and material.trials[each.name].notna().any()
    ]
    if is_virtual(material):
        lacking = (
            "NASA-TLX is asked of people only. These are virtual drivers: they have no "
            "subjective workload, and no numbers are made up for it."
        )
        return [not_drawn(NAME, TITLE, lacking)]
    if not answered:
        columns = " and ".join(each.name for each in WORKLOAD)
        lacking = f"No answers to the NASA-TLX are in trials.csv (columns {columns})."
        return [not_drawn(NAME, TITLE, lacking)]
    return [bars.draw(material, each) for each in answered]
