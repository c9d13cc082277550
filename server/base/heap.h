// Tunes the heap of the C library. Building a layer briefly takes several times the memory of the
// layer; without this, much of that would stay with the process.
#pragma once

namespace trapeze {

/// Makes arrays of more than a megabyte return to the system as soon as they are freed, whatever
/// was freed before. Applies to all threads; call it at the very beginning of main.
void return_large_arrays();

/// Returns free memory between smaller blocks to the system. Takes milliseconds, during which other
/// threads may have to wait for memory: call it when much has been freed. From any thread.
void return_free_memory();

}  // namespace trapeze
