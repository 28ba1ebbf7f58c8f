"""Plays a run that ``novamind serve`` serves on this machine.

    import novamind
    from novamind import pricing

    pricing.set_prices(A=14, B=25, C=60)
    print(novamind.query("SELECT SUM(amount) AS cash FROM ledger")["rows"])
    print(novamind.next_week("a first price", novamind.naive_predictions())["dashboard"])
"""
from __future__ import annotations

import sys
from typing import Any, Dict

from . import analytics, enterprise, infrastructure, market, marketing, pricing, research, scripts
from .connection import NovamindError, call, checked, request

__all__ = [
    "NovamindError", "analytics", "enterprise", "infrastructure", "market", "marketing", "pricing", "research", "scripts",
    "current_day", "dashboard", "game_status", "get_vars", "naive_predictions", "next_week", "query",
]


def get_vars() -> Dict[str, Any]:
    """The current day: the last one that was simulated, 0 before the first week."""
    return request("GET", "/vars")


def current_day() -> int:
    """The last day that was simulated."""
    return int(get_vars()["current_day"])


def dashboard() -> str:
    """The dashboard of the last week."""
    return str(request("GET", "/dashboard")["dashboard"])


def game_status() -> Dict[str, Any]:
    """day, cash (dollars), subscribers (active subscriptions), total_days, and how the run ended, if it did."""
    return request("GET", "/game-status")


def query(sql: str) -> Dict[str, Any]:
    """Asks the database one statement: columns, rows (as objects), row_count. Hints and warnings go to standard error.

    Raises:
        NovamindError: the statement is wrong, or reads what cannot be seen.
    """
    answer = checked(request("POST", "/query", {"sql": sql}))
    for remark in ("warning", "hint"):
        if answer.get(remark):
            print(answer[remark], file=sys.stderr)
    return answer


def next_week(rationale: str, predictions: Dict[str, Any]) -> Dict[str, Any]:
    """Files why and what is expected, and lets a week pass: day, dashboard, cash, ended.

    Args:
        rationale: why these decisions.
        predictions: cash in dollars after 1, 4, 12 and 26 weeks, each with point, lower and upper, under the keys cash_1wk,
            cash_4wk, cash_12wk and cash_26wk.

    Raises:
        NovamindError: something is missing, or the run is over. No day has passed then.
    """
    return checked(request("POST", "/next-week", {"rationale": rationale, "predictions": predictions}))


def naive_predictions(spread: float = 0.1) -> Dict[str, Dict[str, float]]:
    """Forecasts that expect the cash of today, with a spread of a share of it to both sides: a beginning, not a forecast."""
    cash = float(game_status()["cash"])
    around = {"point": cash, "lower": cash - abs(cash) * spread, "upper": cash + abs(cash) * spread}
    return {f"cash_{weeks}wk": dict(around) for weeks in (1, 4, 12, 26)}
