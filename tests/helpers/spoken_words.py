"""From words of the tasks' language to numbers, for tests that read texts."""

from home_mjx.scene_compile.semantics.vocabulary import vocabularies
from home_mjx.tasks.language.phrases import COLUMN
from home_mjx.tasks.language.vocabulary import spoken


def number(word, said):
    return [spoken(name) for name in vocabularies()[COLUMN[word]]].index(said)
