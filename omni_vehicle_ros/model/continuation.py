"""Following the solutions of equations along a parameter, round a fold too (Keller 1977; Seydel 2010, ch. 4).

There are n - 1 equations for n unknowns, the first of which is the parameter, so that the solutions make a curve. Each
point of it comes from the one before by a step along the tangent, and Newton's method in the plane across it.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from omni_vehicle_ros.model.state import Vector

DIFFERENCE = 1e-5  # with equations good to 1e-11, the error of a slope is near 1e-6
NEWTON_STEPS = 12
LAST_STEP = 1e-7  # of Newton's method; the next one would be 1e-12 or so
HALVINGS = 24
STRAIGHTEST = 0.98  # cosine of the largest turn of the tangent in a step
CORNER = 1e-4  # length of a step in which a tangent may turn by more, as the curve has a corner there
FARTHEST = 0.5  # of a step, by which its end may miss the curve; what is found farther away is on another one
FIRST_STEP, SHORTEST_STEP = 1e-2, 1e-7
MOST_STEPS = 4000
ROUNDING = 1e-9  # of the parameter: nearer to a point it is that point


class Point(NamedTuple):
    """A solution: its ``place``, shape (n,), the ``slopes`` of the equations, (n - 1, n), and the ``tangent``, (n,)."""

    place: Vector
    slopes: Vector
    tangent: Vector


class Curve(NamedTuple):
    """The solutions of equations.

    ``equations`` takes a place, shape (n,), and returns what is to be 0, shape (n - 1,), both of the size of 1 more or
    less. ``weights``, shape (n,), say how much each unknown counts in the length of a step.
    """

    equations: Callable[[Vector], Vector]
    weights: Vector

    def at(self, guess: Vector) -> Point | None:
        """Return the solution near a guess with the same parameter, its tangent towards a higher one, or None."""
        return self._across(guess, np.eye(len(guess))[0])

    def stepped(self, point: Point, step: float) -> Point | None:
        """Return the point that lies a step along the tangent from another one, or None if there is none near."""
        guess = point.place + step * point.tangent
        found = self._across(guess, self.weights * point.tangent)
        if found is None or self.weights @ (found.place - guess) ** 2 > (FARTHEST * step) ** 2:
            return None
        return found

    def along(self, point: Point, way: Vector) -> float:
        """Return the length of a way, shape (n,), along the tangent of a point."""
        return float(self.weights * point.tangent @ way)

    def follow(self, first: Point, longest: float) -> Iterator[Point]:
        """Yield the points of the curve after the first one, going where its tangent points.

        Parameters
        ----------
        first
            Where to begin.
        longest
            Longest step; steps are shorter where the curve bends.

        Yields
        ------
        Point
            Until `MOST_STEPS` have been tried, or the curve can't be followed any further.
        """
        point, step = first, min(FIRST_STEP, longest)
        for _ in range(MOST_STEPS):
            if step < SHORTEST_STEP:
                return
            found = self.stepped(point, step)
            if found is None or (step > CORNER and self.along(point, found.tangent) < STRAIGHTEST):
                step *= 0.5
                continue
            yield found
            point, step = found, min(1.5 * step, longest)

    def trace(self, first: Point, longest: float, holds: Callable[[Point], bool]) -> tuple[Point, ...]:
        """Return the points of the curve from the first one on, up to the last one where something holds.

        Of every fold both neighbours are among them, next to each other, so that between any other two points the
        parameter only rises or only falls.

        Parameters
        ----------
        first, longest
            As in `follow`.
        holds
            What is to hold.
        """
        points = [first]
        for point in self.follow(first, longest):
            if (point.tangent[0] > 0.0) != (points[-1].tangent[0] > 0.0):
                points += self.fold(points[-1], point)
            if not holds(point):
                break
            points.append(point)
        return tuple(points)

    def fold(self, before: Point, after: Point) -> tuple[Point, Point]:
        """Return the last point before and the first one after the curve turns back between two neighbours."""
        rising = before.tangent[0] > 0.0
        return self.border(before, after, lambda point: (point.tangent[0] > 0.0) == rising)

    def crossings(self, points: Sequence[Point], level: float) -> list[Point]:
        """Return the points of the curve at a value of the parameter, in the order of the curve.

        Parameters
        ----------
        points
            Of the curve, as `trace` returns them.
        level
            Value of the parameter.
        """
        levels = np.array([point.place[0] for point in points])
        low, high = np.minimum(levels[:-1], levels[1:]), np.maximum(levels[:-1], levels[1:])
        before = np.flatnonzero((low <= level) & (level < high)).tolist()
        found = (self.between(points[i], points[i + 1], level) for i in before)
        return [point for point in found if point is not None]

    def between(self, before: Point, after: Point, level: float) -> Point | None:
        """Return the point at a value of the parameter between two neighbours, None if it can't be found.

        From one to the other the parameter must rise all the way, or fall. Near a fold there is another point with this
        value; it is not meant.
        """
        for end in (before, after):
            if abs(float(end.place[0]) - level) <= ROUNDING:
                return end
        way = after.place - before.place
        reach = self.along(before, way)
        found = self.at(before.place + (level - before.place[0]) / way[0] * way)
        part = self.along(before, found.place - before.place) if found is not None else math.nan
        if found is not None and self.along(before, found.tangent) * way[0] > 0.0 and 0.0 <= part <= reach:
            return found

        def miss(step: float) -> float:
            point = self.stepped(before, step)
            return math.nan if point is None else float(point.place[0]) - level

        return self.stepped(before, brentq(miss, 0.0, reach)) if miss(0.0) * miss(reach) <= 0.0 else None

    def border(self, inside: Point, outside: Point, holds: Callable[[Point], bool]) -> tuple[Point, Point]:
        """Return where something ceases to hold, by halving.

        Parameters
        ----------
        inside, outside
            Neighbours on the curve; it holds at the first and not at the second.
        holds
            What is to hold.

        Returns
        -------
        tuple of Point
            The last point where it holds and the first where it does not; next to nothing lies between them.
        """
        base, low, high = inside, 0.0, self.along(inside, outside.place - inside.place)
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            found = self.stepped(base, middle)
            if found is None:
                break
            if holds(found):
                low, inside = middle, found
            else:
                high, outside = middle, found
        return inside, outside

    def _across(self, guess: Vector, normal: Vector) -> Point | None:
        """Return the solution in the plane through a guess; the tangent points to the side of the normal."""
        place, last = guess, np.eye(len(guess))[-1]
        for _ in range(NEWTON_STEPS):
            slopes = self._slopes(place)
            right = np.column_stack((last, np.append(-self.equations(place), normal @ (guess - place))))
            try:
                tangent, step = np.linalg.solve(np.vstack((slopes, normal)), right).T
            except np.linalg.LinAlgError:
                return None
            place = place + step
            size = np.max(np.abs(step))
            if size <= LAST_STEP:
                return Point(place, slopes, tangent / np.sqrt(self.weights @ tangent**2))
            if not np.isfinite(size):
                return None
        return None

    def _slopes(self, place: Vector) -> Vector:
        steps = DIFFERENCE * np.eye(len(place))
        rises = [self.equations(place + step) - self.equations(place - step) for step in steps]
        return np.array(rises).T / (2.0 * DIFFERENCE)
