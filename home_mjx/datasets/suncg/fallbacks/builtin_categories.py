"""Built-in categories of the SUNCG models that affect walkability, for partial copies without their rows."""

from dataclasses import replace

from home_mjx.datasets.suncg.formats.variants import SuncgMetadata
from home_mjx.schema.house import ModelInfo

# Categories (fine, coarse, NYU40) of SUNCG's ids, as listed by its papers and readers.
_KNOWN = (
    (
        ("door", "door", "door"),
        "122 133 214 246 247 326 327 331 73 756 757 758 759 760 761 762 763 764 768 769 770 s__1762 s__1763 s__1764 "
        "s__1765 s__1766 s__1767 s__1768 s__1769 s__1770 s__1771 s__1772 s__1773",
    ),
    (("garage_door", "garage_door", "door"), "361 765 771"),
    (("arch", "arch", "door"), "778 779 780"),
    (
        ("window", "window", "window"),
        "126 209 210 211 212 213 752 753 754 755 766 767 s__1276 s__2010 s__2011 s__2012 s__2013 s__2014 s__2015 "
        "s__2016 s__2017 s__2019",
    ),
    (
        ("fence", "fence", "door"),
        "368 369 370 371 372 373 374 375 376 379 722 775 776 777 s__2358 s__2362",
    ),
    (
        ("person", "person", "person"),
        "323 324 325 333 346 s__1779 s__1780 s__1781 s__1782 s__1783 s__1784 s__1785 s__1786 s__1787 s__1788 s__1957 "
        "s__1958 s__1959 s__1960 s__1961 s__1962",
    ),
    (
        ("plant", "plant", "otherprop"),
        "130 237 463 620 623 624 634 637 717 718 719 720 721 723 724 725 726 727 728 731 732 733 734 735 736 737 738 "
        "739 740 741 742 786 s__1335 s__1541 s__1543",
    ),
    (("stairs", "stairs", "floor"), "151 152 253 254 782 783 784 785 s__499"),
    (
        ("partition", "partition", "otherstructure"),
        "328 329 330 497 498 502 s__1490 s__1491 s__1492 s__1922 s__2342 s__2343",
    ),
    (("column", "column", "wall"), "365 366 367"),
    (
        ("curtain", "curtain", "curtain"),
        "275 276 621 622 625 747 748 750 751 s__1895 s__1896 s__1897 s__1898 s__1899 s__1900 s__1901 s__1902 s__1903 "
        "s__2041",
    ),
)
BUILTIN_MODELS = {name: ModelInfo(name, *classes) for classes, names in _KNOWN for name in names.split()}


UNKNOWN_CATEGORY = ModelInfo("").coarse


def add_builtin_categories(tables: SuncgMetadata) -> SuncgMetadata:
    """Return tables with the built-in categories of SUNCG's doors, windows and similar models added.

    Rows of `tables` that have a category take precedence. Rows without one, of variants too, get the built-in category
    and keep all else.

    Example:
        >>> add_builtin_categories(SuncgMetadata({})).info("122_0").coarse
        'door'
    """
    merged = SuncgMetadata({**BUILTIN_MODELS, **tables.models}, tables.lights)
    unnamed = {
        name: info for name, info in tables.models.items() if info.coarse == UNKNOWN_CATEGORY
    }  # rows with sizes only
    known = {name: BUILTIN_MODELS[base] for name in unnamed if (base := _base(merged, name)) in BUILTIN_MODELS}
    named = {
        name: replace(unnamed[name], fine=info.fine, coarse=info.coarse, nyu40=info.nyu40)
        for name, info in known.items()
    }
    return SuncgMetadata({**merged.models, **named}, tables.lights)


def has_category(tables: SuncgMetadata, model_id: str) -> bool:
    """Return whether the tables have a coarse category other than `unknown` of a model, or of the base of a variant."""
    return tables.info(model_id).coarse != UNKNOWN_CATEGORY


def _base(tables: SuncgMetadata, model_id: str) -> str:
    """Return the base of a variant, an id that ends in `_` and a digit; the id itself if `tables` lack that base."""
    stem, _, variant = model_id.rpartition("_")
    return stem if stem in tables.models and variant.isdigit() and len(variant) == 1 else model_id
