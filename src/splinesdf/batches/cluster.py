"""Items on a Dask cluster: a few more under way than it has threads, each until it has its row."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from typing import Any

from splinesdf.batches.item import BatchRow, Item, done
from splinesdf.errors import InputError, MissingExtraError
from splinesdf.ground.arrays import shown

# Items under way for each thread of the cluster. More: more shapes lie in the scheduler's memory;
# fewer: a thread waits for the way to us and back.
_AHEAD = 2
# Seconds in which a scheduler and a first worker must answer.
_PATIENCE = 30


def rows_on(scheduler: Any, items: Iterator[Item]) -> Iterator[BatchRow]:
    """The rows of items, as they come, from a cluster.

    Parameters
    ----------
    scheduler : str or dask.distributed.Client
        Its address, as "tcp://10.0.0.1:8786", or a client.
    items : iterator of Item
    """
    try:
        from distributed import Client, as_completed
    except ImportError as error:
        raise MissingExtraError(
            'a batch on a cluster needs Dask: python -m pip install "splinesdf[dask]"'
        ) from error
    if isinstance(scheduler, Client):
        client, own = scheduler, False
    elif isinstance(scheduler, str):
        try:
            # Not the caller's default: what else this program computes stays where it was.
            client = Client(scheduler, timeout=_PATIENCE, set_as_default=False)
            own = True
        except (OSError, ValueError) as error:
            raise InputError(f"no Dask scheduler answers at {shown(scheduler)}") from error
    else:
        raise InputError(
            f"expected the address of a Dask scheduler or a client of it, got {shown(scheduler)}"
        )
    try:
        try:
            client.wait_for_workers(1, timeout=_PATIENCE)
        except TimeoutError as error:
            raise InputError(f"the Dask scheduler has no worker after {_PATIENCE} s") from error
        under_way: dict[Any, Item] = {}

        def submit(item: Item) -> Any:
            # Not "pure": a name made of the content would have it hashed, a shape of any size.
            future = client.submit(done, item, pure=False)
            under_way[future.key] = item
            return future

        ahead = _AHEAD * max(1, sum(client.nthreads().values()))
        coming = as_completed([submit(item) for item in islice(items, ahead)], loop=client.loop)
        for future in coming:
            item = under_way.pop(future.key)
            yield _row(future, item)
            following = next(items, None)
            if following is not None:
                coming.add(submit(following))
    finally:
        if own:
            client.close()


def _row(future: Any, item: Item) -> BatchRow:
    """The row of an item; that of a failure if its workers died over it, or the scheduler did."""
    try:
        row = future.result()
    except Exception as error:
        return BatchRow(item.name, item.output, "failed", " ".join(str(error).split()))
    assert isinstance(row, BatchRow)
    return row
