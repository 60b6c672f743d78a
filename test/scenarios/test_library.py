from pathlib import Path

import pytest

from omni_vehicle_ros.errors import ScenarioError
from omni_vehicle_ros.scenarios import library, load_scenario, scenario_names, variants


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Make the folder of the package's scenarios another one, and its parent the working directory."""
    root = tmp_path / 'scenarios'
    for name in ('tour.yaml', 'alps/climb.yaml', 'alps/descent.yml', 'alps/winter/ice.yaml', 'alps/notes.txt'):
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f'duration: 1.0\ndescription: {name}', encoding='utf-8')
    monkeypatch.setattr(library, 'scenario_directory', lambda: root)
    monkeypatch.chdir(tmp_path)
    return root


def test_names_have_the_folder_in_them_and_come_folder_by_folder(folder: Path) -> None:
    (folder / 'zebra.yaml').write_text('duration: 1.0')
    assert scenario_names() == ('tour', 'zebra', 'alps/climb', 'alps/descent', 'alps/winter/ice')


def test_a_name_is_found_in_any_folder(folder: Path) -> None:
    for name in scenario_names():
        assert load_scenario(name).name == name
        assert variants(name)[0][1].name == name
    assert load_scenario('alps/descent').description == 'alps/descent.yml'


def test_a_name_comes_before_a_path_and_a_path_has_the_name_of_its_file(folder: Path, tmp_path: Path) -> None:
    own = tmp_path / 'alps' / 'climb'
    own.parent.mkdir()
    own.write_text('duration: 2.0')
    assert load_scenario('alps/climb').duration == 1.0
    assert load_scenario('./alps/climb').duration == 2.0
    assert load_scenario(str(folder / 'alps' / 'climb.yaml')).name == 'climb'


@pytest.mark.parametrize(
    ('asked', 'answer'),
    [
        ('tuor', "unknown scenario 'tuor'; did you mean 'tour'?"),
        ('alps/clmb', "unknown scenario 'alps/clmb'; did you mean 'alps/climb'?"),
        ('ice', "unknown scenario 'ice'; did you mean 'alps/winter/ice'? Or give the path of a YAML file"),
        ('ici', "unknown scenario 'ici'; did you mean 'alps/winter/ice'?"),
        ('desnect', "unknown scenario 'desnect'; did you mean 'alps/descent'?"),
        ('ice/climb', "unknown scenario 'ice/climb'; did you mean 'alps/climb'?"),
        ('zzz', "unknown scenario 'zzz'; allowed: tour, alps/climb,"),
        ('alps/climb.yaml', 'alps/climb.yaml: no such file'),
        ('scenarios', 'scenarios: no such file'),
    ],
)
def test_what_is_not_there(folder: Path, asked: str, answer: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        load_scenario(asked)
    assert answer in str(caught.value)
    assert '\n' not in str(caught.value)
