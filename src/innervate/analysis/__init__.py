"""Summary figures from rows: recovery, loss, balance, closed forms, intervals."""
