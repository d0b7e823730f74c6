// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace adit {

/// The page's script, bundled when the program was built (eval/page), and what a content security policy knows it by.
extern const char* const page_script;
extern const char* const page_script_hash;  // "sha256-..."

}  // namespace adit
