// Where instances of a crowd go. Not part of the public interface.
#pragma once

#include "limn/crowd_state.h"

namespace limn {

/// The least free number, for an instance of the mesh, which nothing is known of yet. There may be one more
/// afterwards.
uint32_t take_slot(Crowd::State& state, const BatchMesh& mesh);
/// Writes the instance. False: there is no room; some of it may be there. Errors: as build_patch_trees.
Result<bool> place(Crowd::State& state, uint32_t slot);
/// Makes what is there of an instance inert, and its number free.
void take_away(Crowd::State& state, uint32_t slot);
/// All instances that have a slot, with room for more. Errors: as Crowd::add.
Result<std::unique_ptr<Crowd::State>> lay_out_anew(Crowd::State& old);
/// Brings instance_faces and instance_numbers up to date.
void list_crowd_instances(Crowd::State& state);

}  // namespace limn
