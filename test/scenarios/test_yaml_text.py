import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.errors import ScenarioError
from omni_vehicle_ros.scenarios import yaml_text


@pytest.mark.parametrize(
    ('text', 'value'),
    [
        ('1e5', 1e5), ('1E-3', 1e-3), ('+.5', 0.5), ('7.', 7.0), ('010', 10), ('-3', -3),
        ('on', 'on'), ('no', 'no'), ('1:30', '1:30'), ('true', True), ('~', None), ('.inf', math.inf),
        ('9' * 400, math.inf), ('1_000', '1_000'), ('2020-01-01', '2020-01-01'),
    ],
)
def test_scalars_are_those_of_yaml_1_2(text: str, value: object) -> None:
    parsed = yaml_text.parse(text)
    assert parsed == value
    assert type(parsed) is type(value)


@pytest.mark.parametrize(
    ('text', 'problem'),
    [
        ('a: 1\na: 2', "line 2, column 1: 'a' is there twice"),
        ('1: a', 'line 1, column 1: a key must be a word'),
        ('? [a]\n: b', 'a key must be a word'),
        ('a: &x 1\nb: *x', 'line 2, column 4: aliases are not allowed'),
        ('&x [*x]', 'aliases are not allowed'),
        ('a: [1, 2', 'line 1, column 9'),
        ('a: b: c', 'line 1, column 5'),
        ('!!python/object:os.system x', 'could not determine a constructor'),
        ('--- a\n--- b', 'line 2'),
        ('a: "\x00"', 'special characters are not allowed'),
        ('[' * 5000, 'nested too deeply'),
    ],
)
def test_what_is_malformed_is_said_in_one_line(text: str, problem: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        yaml_text.parse(text)
    assert problem in str(caught.value)
    assert '\n' not in str(caught.value)


@pytest.mark.parametrize('content', [b'\x00\x01mass: 1', b'mass: \xff\xfa', b'\x89PNG\r\n\x1a\n'])
def test_a_file_that_is_no_text_is_called_that(content: bytes) -> None:
    with pytest.raises(ScenarioError, match=r'^is not a text file'):
        yaml_text.parse(content)


CHARACTERS = st.characters(blacklist_categories=('Cs', 'Cc'), blacklist_characters='\u2028\u2029\ufeff\ufffe\uffff')
NUMBERS = st.integers(-10**17, 10**17) | st.floats(allow_nan=False)
SCALARS = st.none() | st.booleans() | NUMBERS | st.text(CHARACTERS, max_size=8)
TREES = st.recursive(
    SCALARS | st.sampled_from(['1e5', '010', 'on', '.5', '$radius', '1:30', '~', '']),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text('ab1e.', max_size=4), inner, max_size=4),
    max_leaves=8,
)


@settings(deadline=None, max_examples=200)
@given(TREES)
def test_what_is_dumped_reads_back_equal(tree: object) -> None:
    again = yaml_text.parse(yaml_text.dump(tree))
    assert again == tree
    assert repr(again) == repr(tree)


@settings(deadline=None, max_examples=200)
@given(st.binary(max_size=40) | st.text('-?:,[]{}#&*!|>\'"%@` a1.\n', max_size=30))
def test_any_document_gives_a_tree_or_a_scenario_error(text: str | bytes) -> None:
    try:
        yaml_text.parse(text)
    except ScenarioError as error:
        assert '\n' not in str(error)
