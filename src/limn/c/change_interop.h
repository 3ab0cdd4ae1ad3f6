// Objects that change, as implementations of the C interface have them. Not part of the public interface.
#pragma once

#include "limn/c/interop.h"
#include "limn/c/limn_changes.h"
#include "limn/crowd.h"
#include "limn/mesh_edit.h"

struct limn_editable_mesh {
    limn::EditableMesh value;
};
struct limn_crowd {
    limn::Crowd value;
};
