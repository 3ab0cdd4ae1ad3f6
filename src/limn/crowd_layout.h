// Where instances of a crowd go. Not part of the public interface.
#pragma once

#include "limn/crowd_state.h"

namespace limn {

using PlanNumbers = std::vector<uint32_t>;  ///< what a mesh's plans are in the crowd

inline Error crowd_too_large(const char* what) {
    return Error{ErrorCode::too_large, std::string("a crowd holds too many ") + what};
}

/// Words of an array of T: from element `first` on.
template <class T>
void mark(Crowd::State& state, CrowdArray array, uint64_t first, uint64_t count) {
    constexpr uint64_t kWords = sizeof(T) / 4;
    state.own_changes[array].mark(first * kWords, count * kWords);
}

// crowd_plans.cpp

/// Plans of a mesh, and trees of those that its surfaces have, are there afterwards. Errors: as
/// build_patch_trees.
Result<PlanNumbers> append_plans(Crowd::State& state, const PatchTable& mesh);

// crowd_write.cpp

/// An instance that has its ranges. False: there is no room in tiles, or for rows of level-1 points.
bool write(Crowd::State& state, Crowd::State::Slot& slot, const PlanNumbers& numbers);
/// What an instance has in tables becomes inert; its ranges stay its own.
void erase(Crowd::State& state, Crowd::State::Slot& slot);
/// Elements [first, first + count) become those of nobody. Number 0 of rows, corners and rate edges is.
void make_inert(Crowd::State& state, CrowdRange range, uint32_t first, uint32_t count);

// crowd_layout.cpp

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
