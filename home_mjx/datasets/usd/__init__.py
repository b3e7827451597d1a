"""Reader of OpenUSD scenes; needs the extra `usd`."""
