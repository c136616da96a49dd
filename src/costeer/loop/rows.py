"""The row of a sample of the loop: the columns of a record, and those of a method."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, Generic, NamedTuple

from costeer.controller.signals import Request
from costeer.drivers.interface import DriverModel, DriverNoise, law_of
from costeer.drivers.population import VIRTUAL
from costeer.loop.half_step import Sample
from costeer.loop.parameters import LoopParameters
from costeer.loop.step import Rules, initial_state, sense, step
from costeer.methods.interface import Method, P, S, rule_of, usual_parameters
from costeer.records.columns import with_method_columns
from costeer.records.row import RowWriter, row_writer


def rules_of(
    method: Method[P, S], driver: DriverModel[Any, Any] = VIRTUAL
) -> Rules[P, S]:
    """What the loop calls of a method and of a driver."""
    return Rules(method=rule_of(method), driver=law_of(driver))


def sample_like(method: Method[P, S]) -> Sample[S]:
    """A sample of a method's loop, whose kinds and places are those of all."""
    rules = rules_of(method)
    parameters = LoopParameters(controller=usual_parameters(method))
    state = initial_state(rules, parameters)
    noise = DriverNoise(*([0.0] * len(DriverNoise._fields)))
    measurement = sense(parameters, state)
    _, sample = step(rules, parameters, state, measurement, Request(), noise)
    return sample


@cache
def writer_of(method: Method[P, S]) -> RowWriter:
    """What fills the rows of a method's trials.

    Raises:
        ValueError: If a column of the method is none, or lies at a place that its
            state does not have.
    """
    columns = with_method_columns(method.columns)
    return row_writer(columns, sample_like(method))


class LoopRule(NamedTuple, Generic[P, S]):
    """All functions that a loop is made of.

    Attributes:
        rules: Of method and driver.
        fill: Writes a sample into a row.
    """

    rules: Rules[P, S]
    fill: Callable[[Any, Any], None]  # Any: an array, and a sample of the method


def loop_rule(
    method: Method[P, S], driver: DriverModel[Any, Any] = VIRTUAL
) -> LoopRule[P, S]:
    """The functions of the loop of a method and a driver.

    Raises:
        ValueError: If a column of the method is none.
    """
    return LoopRule(rules_of(method, driver), writer_of(method).fill)
