//! Resolution of open issues by support pools, each with a part of the operations budget
//! (`docs/mechanics/retention/issues.md#pools`).

use super::issues::{IssueBatch, mean_resolved};
use crate::customers::Customers;
use crate::customers::columns::Block;
use crate::identifiers::{ByGroup, Group, Plan};
use crate::params::Params;
use crate::random::{Part, Streams};
use crate::settings::Settings;

/// A set of open issues that share one operations budget.
#[derive(Debug, Clone, Copy)]
enum SupportPool {
    AllIssues,
    Group(Group),
    Plan(Plan),
    GroupPlan(Group, Plan),
    Customer(u32),
}

impl SupportPool {
    /// Returns the keys of the pool's random stream: kind and number of the pool.
    fn keys(self) -> [u64; 2] {
        match self {
            SupportPool::AllIssues => [0, 0],
            SupportPool::Group(group) => [1, group.index() as u64],
            SupportPool::Plan(plan) => [2, plan.index() as u64],
            SupportPool::GroupPlan(group, plan) => [3, (group.index() * 3 + plan.index()) as u64],
            SupportPool::Customer(customer) => [4, u64::from(customer)],
        }
    }

    fn contains(self, group: Group, block: &Block, at: usize) -> bool {
        match self {
            SupportPool::AllIssues => true,
            SupportPool::Group(pool_group) => group == pool_group,
            SupportPool::Plan(plan) => block.plan[at] == plan,
            SupportPool::GroupPlan(pool_group, plan) => group == pool_group && block.plan[at] == plan,
            SupportPool::Customer(customer) => block.customer[at] == customer,
        }
    }

    fn contains_all_issues_of(self, group: Group) -> bool {
        matches!(self, SupportPool::AllIssues)
            || matches!(self, SupportPool::Group(pool_group) if pool_group == group)
    }

    /// Returns the group in the pool's definition, or `None` if no group defines the pool.
    fn defining_group(self) -> Option<Group> {
        match self {
            SupportPool::Group(group) | SupportPool::GroupPlan(group, _) => Some(group),
            _ => None,
        }
    }
}

/// The resolution of all issues on one day.
pub(super) struct ResolutionRound<'a> {
    pub day: u32,
    pub calls: &'a mut [IssueBatch],
    pub customers: &'a Customers,
    pub params: &'a Params,
    pub streams: &'a Streams,
}

impl ResolutionRound<'_> {
    /// Processes the pools from the widest to the narrowest. Each pool resolves issues that earlier pools left open.
    pub fn resolve_all(&mut self, settings: &Settings) {
        let base = self.params.issues.issue_resolution_base_rate;
        self.resolve_pool(SupportPool::AllIssues, base, settings.core.operations);
        let targeted = &settings.targeted_operations;
        for (&group, &spend) in &targeted.by_group {
            self.resolve_pool(SupportPool::Group(group), 0.0, spend);
        }
        for (&plan, &spend) in &targeted.by_plan {
            self.resolve_pool(SupportPool::Plan(plan), 0.0, spend);
        }
        for (&group, plans) in &targeted.by_group_plan {
            for (&plan, &spend) in plans {
                self.resolve_pool(SupportPool::GroupPlan(group, plan), 0.0, spend);
            }
        }
        for (&customer, &spend) in &targeted.by_customer {
            if let Ok(customer) = u32::try_from(customer) {
                self.resolve_pool(SupportPool::Customer(customer), 0.0, spend);
            }
        }
    }

    fn resolve_pool(&mut self, pool: SupportPool, base: f64, spend: f64) {
        if base <= 0.0 && spend <= 0.0 {
            return;
        }
        let members = self.members(pool);
        let pool_issues: u32 = members.iter().map(PoolMembers::count).sum();
        for (group, pool_members) in
            Group::all().zip(&members.0).filter(|(_, pool_members)| pool_members.count() > 0)
        {
            let [kind, which] = pool.keys();
            let keys = [u64::from(self.day), kind, which, group.index() as u64];
            let mut stream = self.streams.open(Part::IssueResolution, keys);
            let mean =
                mean_resolved(base, spend, group, pool_members.count(), pool_issues, &self.params.issues);
            let solved = stream.poisson(mean).min(u64::from(pool_members.count())) as usize;
            let mut order: Vec<u32> = (0..pool_members.count()).collect();
            let mut chosen = vec![false; order.len()];
            // Partial shuffle: the first `solved` members are a uniform sample without replacement.
            for first in 0..solved {
                let other = first + stream.index(order.len() - first);
                order.swap(first, other);
                chosen[order[first] as usize] = true;
            }
            pool_members.mark_resolved(&chosen, self.calls);
        }
    }

    /// Returns the unresolved issues of a pool by group.
    fn members(&self, pool: SupportPool) -> ByGroup<PoolMembers> {
        let mut members: ByGroup<PoolMembers> = ByGroup::default();
        let calls = (0..).zip(&*self.calls);
        for (number, issue_batch) in
            calls.filter(|(_, batch)| pool.defining_group().is_none_or(|group| group == batch.group))
        {
            let group_members = &mut members[issue_batch.group];
            if pool.contains_all_issues_of(issue_batch.group) && !issue_batch.solved.contains(&true) {
                group_members.add_block(number, issue_batch.open.len() as u32);
                continue;
            }
            let block = &self.customers.groups[issue_batch.group].blocks[issue_batch.block as usize];
            for (entry, (&at, &solved)) in (0..).zip(issue_batch.open.iter().zip(&issue_batch.solved)) {
                if !solved && pool.contains(issue_batch.group, block, usize::from(at)) {
                    group_members.add(number, entry);
                }
            }
        }
        members
    }
}

/// The open issues that one group has in a pool, in block order. They are stored as runs of consecutive entries of an
/// [`IssueBatch`]. A block is a single run if the pool contains all its issues and none is resolved, as in the first
/// pool of a day.
#[derive(Default)]
struct PoolMembers {
    runs: Vec<MemberRun>,
    count: u32,
}

struct MemberRun {
    /// Number of the run's first member within the pool.
    first: u32,
    /// Index of the block's issue batch.
    calls: u32,
    /// Position of the run's first member in the issue batch.
    entry: u32,
}

impl PoolMembers {
    fn count(&self) -> u32 {
        self.count
    }

    fn add(&mut self, calls: u32, entry: u32) {
        self.runs.push(MemberRun { first: self.count, calls, entry });
        self.count += 1;
    }

    fn add_block(&mut self, calls: u32, entries: u32) {
        if entries > 0 {
            self.runs.push(MemberRun { first: self.count, calls, entry: 0 });
            self.count += entries;
        }
    }

    /// Marks the chosen issues as resolved. `chosen` has one value per member.
    fn mark_resolved(&self, chosen: &[bool], calls: &mut [IssueBatch]) {
        let ends = self.runs.iter().skip(1).map(|next| next.first).chain([self.count]);
        for (run, end) in self.runs.iter().zip(ends) {
            let chosen = &chosen[run.first as usize..end as usize];
            let entry = run.entry as usize;
            calls[run.calls as usize].solved[entry..entry + chosen.len()].copy_from_slice(chosen);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mark_resolved_handles_single_members_and_blocks() {
        let block = |open: u16| IssueBatch {
            group: Group::at(0).expect("S1"),
            block: 0,
            open: (0..open).collect(),
            new: Vec::new(),
            solved: vec![false; usize::from(open)],
            first_issue: 0,
        };
        let mut calls = vec![block(3), block(0), block(10), block(1), block(2)];
        let mut members = PoolMembers::default();
        members.add_block(0, 3);
        members.add_block(1, 0);
        members.add(2, 7);
        members.add(2, 9);
        members.add_block(4, 2);
        assert_eq!(members.count(), 7);
        members.mark_resolved(&[false, true, true, true, false, false, true], &mut calls);
        let solved = |issue_batch: &IssueBatch| -> Vec<usize> {
            (0..issue_batch.solved.len()).filter(|at| issue_batch.solved[*at]).collect()
        };
        let solved: Vec<Vec<usize>> = calls.iter().map(solved).collect();
        assert_eq!(solved, [vec![1, 2], vec![], vec![7], vec![], vec![1]]);
    }
}
