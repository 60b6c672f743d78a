"""Analysis of any bags, from one reading of each in bounded memory."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from omni_vehicle_ros.analysis.stream.limits import limits_of
from omni_vehicle_ros.analysis.stream.reading import BagReader, Progress
from omni_vehicle_ros.analysis.stream.summary import compared, metrics_of
from omni_vehicle_ros.analysis.stream.survey import Survey, survey_bag
from omni_vehicle_ros.errors import BagError, ScenarioError
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.scenarios import Scenario, load_scenario

MOST_BAGS = 6


class Subject(NamedTuple):
    """A bag to be analysed: where it is, what it is called, how it is read, and its scenario, if that is known."""

    path: Path
    name: str
    reader: BagReader
    scenario: Scenario | None
    hint: str
    """What the reader of a report should know about the scenario."""


class Analysis(NamedTuple):
    """What was found in some bags."""

    subjects: tuple[Subject, ...]
    surveys: tuple[Survey, ...]
    metrics: dict[str, Any]
    """As in metrics.json."""


def read_subjects(paths: Sequence[Path], scenario: Scenario | None = None) -> tuple[Subject, ...]:
    """Look for bags, before anything is written.

    Parameters
    ----------
    paths
        Bag directories or files, or directories of runs.
    scenario
        Of all of them; by default each one's own, ``scenario.yaml`` in the directory of the run.

    Raises
    ------
    BagError
        There is no such bag, or there are too many.
    """
    if len(paths) > MOST_BAGS:
        raise BagError(f'{len(paths)} bags are too many to be compared; name {MOST_BAGS} at most')
    return tuple(_subject(path, scenario) for path in paths)


def _subject(path: Path, scenario: Scenario | None) -> Subject:
    path = path / 'bag' if (path / 'bag').is_dir() and not any(path.glob('*.mcap')) else path
    directory = path if path.is_dir() else path.parent
    run = directory.resolve().parent
    name = run.name if directory.resolve().name == 'bag' else path.stem
    hint = '' if scenario else 'There is no scenario.yaml beside the bag: limits and dimensions are the default ones.'
    if scenario is None and (run / 'scenario.yaml').is_file():
        try:
            scenario, hint = load_scenario(str(run / 'scenario.yaml')), ''
        except ScenarioError as error:
            hint = f'{error}. Limits and dimensions are the default ones.'
    return Subject(path, name or path.name, BagReader(path), scenario, hint)


def analyse(
    subjects: Sequence[Subject], namespace: str | None = None, progress: Progress = lambda read: None
) -> Analysis:
    """Read bags, and return what they say.

    Parameters
    ----------
    subjects
        As `read_subjects` gives them.
    namespace
        Of the vehicle; None: the one that there is.
    progress
        Called with what was read of all of them [MB].

    Raises
    ------
    BagError
        A bag can't be read, has no messages that are read here, or holds several vehicles.
    """
    done, surveys = 0.0, []
    for subject in subjects:
        survey = survey_bag(
            subject.path, limits_of(subject.scenario), namespace=namespace, reader=subject.reader,
            progress=_after(done, progress),
        )
        if not survey.timing:
            raise BagError(f'{subject.path} has no messages that are read here; its topics: {_topics(survey)}')
        surveys.append(survey)
        done += subject.reader.size
    bags = [metrics_of(survey) for survey in surveys]
    differences = {name: [*more] for name, _, _, more in compared(bags)} if len(bags) > 1 else {}
    return Analysis(tuple(subjects), tuple(surveys), {'bags': bags, 'differences': differences})


def _after(done: float, progress: Progress) -> Callable[[float], None]:
    return lambda read: progress(done + read)


def _topics(survey: Survey) -> str:
    return ', '.join(f'{topic} ({type_name})' for topic, type_name in sorted(survey.types.items())[:10]) or 'none'


def vehicle_of(subject: Subject) -> VehicleParameters:
    """Return the dimensions to draw with."""
    return subject.scenario.vehicle if subject.scenario else VehicleParameters()
