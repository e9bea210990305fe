// SPDX-License-Identifier: MIT
// The base of readers over C libraries that report an error by a longjmp.
#pragma once

#include <csetjmp>
#include <cstdio>

namespace kelp::bake {

// A longjmp runs no destructors. So code between caught() and the library's jump must own nothing.
class JumpCatcher {
 public:
  const char* reason() const { return reason_; }

 protected:
  // Runs work(). False if it jumped out: reason() says why.
  template <class Work>
  bool caught(const Work& work) {
    if (setjmp(out_)) return false;
    work();
    return true;
  }
  [[noreturn]] void fail(const char* reason) {
    std::snprintf(reason_, sizeof reason_, "%s", reason);
    std::longjmp(out_, 1);
  }

 private:
  std::jmp_buf out_;
  char reason_[200] = "";
};

}  // namespace kelp::bake
