import csv
import itertools
import math

import numpy as np
import pytest

from omni_vehicle_ros.analysis.map_request import MapRequest, even_grid, read_request
from omni_vehicle_ros.analysis.stability_map import draw_map
from omni_vehicle_ros.analysis.style import house_style
from omni_vehicle_ros.analysis.turn_map import TurnMap, field, turn_map, worst_slip, write_tables
from omni_vehicle_ros.errors import CommandError, ParameterError
from omni_vehicle_ros.model.dynamics import Environment
from omni_vehicle_ros.model.steady_turn import limit_speed, steady_turn, steady_turns
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.wheels import WHEELS

CAR, SNOW = VehicleParameters(), Environment(friction=(0.5,) * 4)
RADII, SPEEDS = (2.0, 5.0, 8.5, 10.0, 30.0), (1.0, 3.0, 6.0, 9.0, 13.0)


@pytest.fixture(scope='module')
def found() -> TurnMap:
    return turn_map(MapRequest('snow', CAR, SNOW, RADII, SPEEDS))


def read(path):
    with path.open(encoding='utf-8', newline='') as file:
        return list(csv.DictReader(file))


def test_every_radius_and_speed_has_its_row(found, tmp_path):
    write_tables(found, tmp_path)
    rows = read(tmp_path / 'map.csv')
    assert [(float(row['radius']), float(row['speed'])) for row in rows] == list(itertools.product(RADII, SPEEDS))
    for row in rows:
        turn = steady_turn(CAR, float(row['radius']), float(row['speed']), SNOW)
        assert row['slow_driving'] == ('false' if turn is None else 'true')
        if turn is None:
            assert float(row['margin']) < 0.0
            continue
        assert row['exists'] == 'true'
        assert row['stable'] == str(turn.stable).lower()
        assert float(row['decay_rate']) == pytest.approx(turn.decay_rate, rel=1e-5)
        assert float(row['path_radius']) == pytest.approx(turn.path_radius, rel=1e-6)
        values = complex(float(row['eigenvalue_1_real']), float(row['eigenvalue_1_imag']))
        assert min(abs(values - expected) for expected in turn.eigenvalues) < 1e-5 * abs(values)
        for wheel, slip, region in zip(WHEELS, turn.side_slip, turn.region, strict=True):
            assert float(row[f'side_slip_{wheel}']) == pytest.approx(slip, rel=1e-6)
            assert row[f'region_{wheel}'] == region.name.lower()


def test_where_slow_driving_leads_to_none_another_turn_is_there_or_not(tmp_path):
    """Of 7.5 m at 8 and 15 m/s, of 8.5 m at 8, 9.6, 10.5 and 15 m/s, as random starts find them."""
    write_tables(turn_map(MapRequest('', CAR, Environment(), (7.5, 8.5), (8.0, 9.6, 10.5, 15.0))), tmp_path)
    flags = [(row['exists'], row['slow_driving'], row['stable']) for row in read(tmp_path / 'map.csv')]
    slow, drift, unstable, none = (
        ('true', 'true', 'true'), ('true', 'false', 'true'), ('true', 'false', 'false'), ('false', 'false', 'false'))
    assert flags[:4] == [slow, none, unstable, drift]
    assert flags[4:] == [slow, none, drift, drift]


def test_a_row_without_any_turn_is_empty(tmp_path):
    write_tables(turn_map(MapRequest('', CAR, Environment(), (5.0, 6.0), (7.5, 8.0))), tmp_path)
    row = read(tmp_path / 'map.csv')[0]
    assert (row['exists'], row['slow_driving'], row['stable']) == ('false', 'false', 'false')
    assert set(list(row.values())[6:]) == {''}


def test_every_radius_has_its_limit(found, tmp_path):
    write_tables(found, tmp_path)
    limits = read(tmp_path / 'limit.csv')
    for row, radius in zip(limits, RADII, strict=True):
        limit = limit_speed(CAR, radius, SNOW)
        assert float(row['radius']) == radius
        if limit.speed is None or limit.speed > SPEEDS[-1]:
            assert (row['limit_speed'], row['cause'], row['path_radius']) == ('', '', '')
            continue
        assert row['cause'] == limit.cause
        assert float(row['limit_speed']) == pytest.approx(limit.speed, abs=1e-4)
        first = float(row['nonlinear_speed'])
        assert max(steady_turn(CAR, radius, first + 1e-3, SNOW).region) == 1
        assert max(steady_turn(CAR, radius, first - 4e-3, SNOW).region) == 0
    assert [row['cause'] for row in limits] == ['fold', 'fold', 'fold', '', '']


def test_where_both_tyres_of_an_axle_slide_nothing_is_lost(found, tmp_path):
    write_tables(found, tmp_path)
    row = read(tmp_path / 'limit.csv')[3]
    slide = steady_turns(CAR, 10.0, SNOW).limit.slide_speed
    assert float(row['axle_sliding_speed']) == pytest.approx(slide, abs=1e-4)
    assert float(row['sliding_speed']) < slide < SPEEDS[-1]
    last = next(row for row in read(tmp_path / 'map.csv') if (row['radius'], row['speed']) == ('10', '13'))
    assert (last['slow_driving'], last['stable'], last['margin']) == ('true', 'true', '')
    assert [last[f'region_{wheel}'] for wheel in WHEELS[:2]] == ['sliding', 'sliding']


@pytest.fixture(scope='module')
def swaying() -> TurnMap:
    """A heavy vehicle with its load at the rear: it oscillates in turns near 9 m, from 8.6 m/s on, up to 13 or so."""
    car = VehicleParameters(mass=1800.0, cg_to_front_axle=1.5, cg_to_rear_axle=1.2)
    return turn_map(MapRequest('', car, Environment(), (8.0, 9.0, 10.0), (8.0, 10.0, 12.0, 15.0)))


def test_slow_driving_leads_to_the_limit_and_not_beyond(swaying, tmp_path):
    write_tables(swaying, tmp_path)
    rows = read(tmp_path / 'map.csv')
    assert [row['cause'] for row in read(tmp_path / 'limit.csv')] == ['', 'oscillation', 'fold']
    for row in rows:
        assert row['slow_driving'] == str(row['margin'] == '' or float(row['margin']) >= 0.0).lower()
        assert row['slow_driving'] == 'false' or (row['exists'], row['stable']) == ('true', 'true')
    flags = [(row['exists'], row['slow_driving'], row['stable']) for row in rows if row['radius'] == '9']
    slow, unstable, again = ('true', 'true', 'true'), ('true', 'false', 'false'), ('true', 'false', 'true')
    assert flags == [slow, unstable, unstable, again]


def test_above_the_limit_nothing_looks_stable_that_is_not(swaying):
    """The hatched band begins at the limit, of an unstable turn, too; the limit of a single radius is a mark."""
    with house_style():
        axes = draw_map(swaying).axes[0]
    band = next(artist for artist in axes.collections if artist.get_hatch())
    (path,) = band.get_paths()
    limits = [steady_turns(swaying.request.vehicle, radius).limit.speed for radius in (9.0, 10.0)]
    for radius, limit in zip((9.0, 10.0), limits, strict=True):
        low = min(y for x, y in path.vertices if x == radius)
        assert low == pytest.approx(limit, abs=1e-4)
    line = next(line for line in axes.get_lines() if line.get_label() == 'limit speed: oscillation')
    assert line.get_marker() != 'None'
    assert [line.get_ydata()[i] for i in line.get_markevery()] == pytest.approx(limits[:1], abs=1e-4)


def test_a_field_meets_the_turns_and_stays_as_it_was_beyond_the_last_one(found):
    speeds = np.array([1.0, 4.0, 12.9])
    slip = field(found, worst_slip, speeds)
    assert slip.shape == (3, 5)
    assert slip[0] == pytest.approx([worst_slip(steady_turn(CAR, radius, 1.0, SNOW)) for radius in RADII])
    last = steady_turn(CAR, 2.0, limit_speed(CAR, 2.0, SNOW).speed, SNOW)
    assert slip[1:, 0] == pytest.approx(worst_slip(last), rel=1e-3)
    assert slip[2, 4] == pytest.approx(worst_slip(steady_turn(CAR, 30.0, 12.9, SNOW)), rel=0.02)


def test_progress_comes_radius_by_radius():
    done = []
    turn_map(MapRequest('', CAR, Environment(), (20.0, 30.0), (1.0, 2.0)), done.append)
    assert done == [0, 1, 2]


def test_a_road_without_grip_gives_an_empty_map(tmp_path):
    ice = turn_map(MapRequest('ice', CAR, Environment(bank=0.3, friction=(0.05,) * 4), (5.0, 6.0), (1.0, 2.0)))
    write_tables(ice, tmp_path)
    assert {row['exists'] for row in read(tmp_path / 'map.csv')} == {'false'}
    assert {row['limit_speed'] for row in read(tmp_path / 'limit.csv')} == {'0'}
    assert np.all(np.isnan(field(ice, worst_slip, np.array([1.0, 2.0]))))


def test_the_picture_shows_limits_and_where_there_is_no_turn(found):
    with house_style():
        figure = draw_map(found)
    left, right = figure.axes[:2]
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    lost = 'no stable steady turn on the curves that slow driving begins'
    other = 'a stable one, but not the one that slow driving leads to'
    assert {lost, other, 'limit speed: fold', 'both tyres of an axle slide', 'a tyre slides'} <= set(labels)
    for axes in (left, right):
        limit = next(line for line in axes.get_lines() if line.get_label() == 'limit speed: fold')
        drawn = [speed for speed in limit.get_ydata() if math.isfinite(speed)]
        assert drawn == pytest.approx([limit_speed(CAR, radius, SNOW).speed for radius in RADII[:3]], abs=1e-4)
        assert axes.get_xlim() == (2.0, 30.0)
        assert axes.get_ylim() == (1.0, 13.0)


def test_a_road_on_which_slow_driving_leads_everywhere_has_no_other_turns():
    with house_style():
        figure = draw_map(turn_map(MapRequest('', CAR, Environment(), (20.0, 30.0), (1.0, 2.0))))
    assert 'a stable one, but not the one that slow driving leads to' not in [
        text.get_text() for text in figure.legends[0].get_texts()]


def write_file(path, text):
    path.write_text(text, encoding='utf-8')
    return path


@pytest.mark.parametrize(('text', 'road'), [
    ('mass: 1500.0', Environment()),
    ('vehicle: {mass: 1500.0}\nplant: {friction: [0.5, 0.5, 0.5, 0.5]}', SNOW),
    ('/**:\n  ros__parameters: {mass: 1500.0}\n/**/plant:\n  ros__parameters: {wind: 3.0, pacing: realtime}',
     Environment(wind=3.0)),
    ('duration: 1.0\nplant: {bank: 0.01}\nenvironment: [{at: 0, friction: 0.4}, {at: 0.5, friction: 0.8}]',
     Environment(0.01, 0.0, (0.4,) * 4)),
    ('duration: 1.0\nenvironment: [{profile: wind, points: [[0, 2.0], [1, 5.0]]}]', Environment(wind=2.0)),
    ('duration: 1.0\nenvironment: [{profile: wind, points: [[0.5, 2.0], [1, 5.0]]}]', Environment()),
])
def test_the_road_of_a_file_is_the_road_of_its_map(tmp_path, text, road):
    path = write_file(tmp_path / 'car.yaml', text)
    assert read_request(path, [], None, '2:8', '1:5').environment == road
    icy = read_request(path, [], 0.2, '2:8', '1:5')
    assert icy.environment == road._replace(friction=(0.2,) * 4)


def test_the_title_says_what_road_it_is(tmp_path):
    text = 'vehicle: {}\nplant: {bank: 0.01, wind: -2, friction: [0.9, 0.5, 0.9, 0.5]}'
    path = write_file(tmp_path / 'car.yaml', text)
    assert read_request(path, [], None, '2:8', '1:5').title == (
        'car, friction 0.9 0.5 0.9 0.5, bank 0.01 rad, wind -2 m/s')


@pytest.mark.parametrize('text', ['2', '2:', ':', 'a:b', '1:2:3', '0:5', '5:2', '3:3', '-2:2', 'nan:2', '1:inf', ''])
def test_what_is_no_range_is_refused(text):
    with pytest.raises(ParameterError, match='--radius'):
        even_grid('--radius', text, 100.0, 'm')


def test_a_range_ends_where_no_road_vehicle_goes():
    assert even_grid('--speed', '1:100', 100.0, 'm/s')[-1] == 100.0
    with pytest.raises(ParameterError, match=r'--speed: 100\.5 m/s is above 100 m/s'):
        even_grid('--speed', '1:100.5', 100.0, 'm/s')


def test_a_request_is_checked_before_anything_is_done():
    request = read_request(None, ['mass=1400'], 0.5, '0.8:8', '1:5')
    assert request.vehicle == VehicleParameters(mass=1400.0)
    assert request.environment == SNOW
    assert request.title == 'default vehicle, mass=1400, friction 0.5'
    assert (request.radii[0], request.radii[-1]) == (0.8, 8.0)
    assert np.ptp(np.diff(request.speeds)) == pytest.approx(0.0, abs=1e-12)
    with pytest.raises(CommandError, match=r'0\.718'):
        read_request(None, [], 0.9, '0.5:8', '1:5')
    with pytest.raises(ParameterError, match='friction'):
        read_request(None, [], 3.0, '2:8', '1:5')
