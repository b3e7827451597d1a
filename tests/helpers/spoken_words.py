"""From words of the tasks' language to numbers, for tests that read texts."""

from home_mjx.schema.vocabulary import vocabularies
from home_mjx.tasks.language.phrases import SEMANTIC_COLUMN
from home_mjx.tasks.language.vocabulary import to_word


def number(word, said):
    return [to_word(name) for name in vocabularies()[SEMANTIC_COLUMN[word]]].index(said)
