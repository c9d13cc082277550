// How this process deals with the heap of the C library. Building a layer takes several times the
// memory of the layer, for a moment; without this, much of that would stay with the process.
#pragma once

namespace trapeze {

/// Has arrays of more than a megabyte go back to the system as soon as they are freed, whatever was
/// freed before. Call it first thing in main: it holds for all threads.
void return_large_arrays();

/// Gives back what is free between smaller items. Takes milliseconds, in which other threads may
/// have to wait for memory: call it when much has been freed. From any thread.
void return_free_memory();

}  // namespace trapeze
