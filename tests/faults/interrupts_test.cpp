// The end of a run by a handler, while the run itself goes on in another thread.
#include "tetropolis/interrupts.h"

#include <atomic>
#include <chrono>
#include <csignal>
#include <thread>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

namespace tetropolis {
namespace {

std::atomic<bool> is_ending{false};

void sleep_in_handler() {
  is_ending = true;
  const timespec third{0, 300'000'000};
  nanosleep(&third, nullptr);
}

/// The exit code of a process in which a second signal ends the run in one thread, which takes a
/// while, and the files that are gone have the other fail.
int code_of_ended_run() {
  const pid_t child = fork();
  if (child == 0) {
    app::catch_interrupts();
    app::watch_output().begins(sleep_in_handler);
    std::thread ended([] {
      raise(SIGINT);
      raise(SIGINT);
    });
    while (!is_ending) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    app::wait_if_ending();
    _exit(3);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

TEST(Interrupts, WhatFailsWhileAHandlerEndsTheRunIsInterrupted) {
  EXPECT_EQ(code_of_ended_run(), app::kInterruptedExit);
}

TEST(Interrupts, WithoutSignalsNothingIsWaitedFor) {
  app::wait_if_ending();
  EXPECT_FALSE(app::interrupted());
}

}  // namespace
}  // namespace tetropolis
