"""What tests do that wait for something to happen, on the wall clock."""

import time
import xmlrpc.client

import rosgraph
import rospy

PATIENCE = 20.0  # seconds


def wait_for(what, patience=PATIENCE):
    """@return what `what` returns, once that is something."""
    deadline = time.monotonic() + patience
    while True:
        value = what()
        if value:
            return value
        if time.monotonic() > deadline:
            raise AssertionError("it does not happen: " + (what.__doc__ or repr(what)))
        time.sleep(0.002)


def process_of(node):
    """@return the number of its process."""
    master = rosgraph.Master(rospy.get_name())
    _, _, process = xmlrpc.client.ServerProxy(master.lookupNode(node)).getPid(rospy.get_name())
    return process
